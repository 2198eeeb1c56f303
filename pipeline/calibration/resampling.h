// Planes taken at other places, to a 32nd of a pixel.
#pragma once

#include "pipeline/calibration/undistortion_map.h"
#include "src/core/array.h"

#include <eventide/frame.h>

#include <cstdint>
#include <vector>

namespace eventide {

enum class Resampling {
    nearest,
    linear,
    cubic,  ///< Keys' kernel with a = -3/4
};

/// Where each pixel of a plane comes from. Made once; apply() allocates nothing where `to` has the
/// right size already.
class ResamplingMap {
public:
    /// `places` are those of the frame; only `source`, a part of it, is given to apply(). Further
    /// than half a pixel outside it there is nothing.
    ResamplingMap(const SourcePlaces& places, const Region& source);

    int source_width() const { return source_width_; }
    int source_height() const { return source_height_; }

    /// `from` is as large as the source. At its edges its outer pixels go on; where there is
    /// nothing stands `blank`.
    void apply(const Array2<float>& from, Array2<float>& to, Resampling how, float blank) const;

private:
    /// In 32nds of a pixel; x is kNothing where there is nothing.
    struct Place {
        std::int32_t x, y;
    };
    template <int kTaps, typename Weights>
    void take(const Array2<float>& from, std::span<float> to, const Weights& weights,
              float blank) const;

    int width_, height_, source_width_, source_height_;  // px
    std::vector<Place> places_;
};

}  // namespace eventide
