// LPIPS v0.1 (Zhang et al. 2018): how different two images look, by the features of a network
// trained to name what images show.
#pragma once

#include "src/core/array.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace eventide {

/// SqueezeNet 1.1 or AlexNet with their linear heads, whichever the file holds. Const functions:
/// any thread, also at once.
class Lpips {
public:
    /// An npz file with core.net.slice*.*, core.lins.*.model.1.weight and
    /// core.scaling_layer.*. Throws Error(input).
    explicit Lpips(const std::filesystem::path& weights);
    ~Lpips();

    /// "LPIPS-Squeeze" or "LPIPS-Alex": the two give different numbers, so every report says which.
    const std::string& name() const { return name_; }

    /// What the network sees in an image; compute it once for an image compared often.
    struct Features {
        int height = 0, width = 0;          ///< px, of the image
        std::vector<Array3<float>> layers;  ///< each pixel's numbers divided by their norm
    };

    /// `image` [y][x] in [0, 1], grey, shown to the network as three equal channels; or [y][x][3]
    /// red, green, blue. Throws Error(usage) where it is smaller than 17x17 (Squeeze) or 31x31
    /// (Alex).
    Features features(const Array2<float>& image) const;
    Features features(const Array3<float>& image) const;

    /// 0 for equal images; about 0.1 similar, 0.7 unlike. Both of one size.
    double distance(const Features& a, const Features& b) const;

    /// Where the distance comes from, [y][x] of the image's size: each layer's differences
    /// brought to that size bilinearly (as the authors' `spatial=True`) and added.
    Array2<float> distance_map(const Features& a, const Features& b) const;

private:
    struct Network;
    Array2<float> layer_differences(const Features& a, const Features& b, std::size_t layer) const;

    std::string name_;
    std::unique_ptr<const Network> network_;
};

/// LPIPS from a weights file, or nothing where the path is empty.
std::unique_ptr<const Lpips> load_lpips(const std::filesystem::path& weights);

}  // namespace eventide
