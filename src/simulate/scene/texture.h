// One grey image made for being looked up: mirrored without end, anti-aliased at any size.
#pragma once

#include "src/core/array.h"
#include "src/simulate/scene/affine.h"

#include <cstdint>
#include <span>
#include <vector>

namespace eventide {

/// A pyramid of halved images. Place is told in "turns" of 32 bits: 2^31 is one image width or
/// height and the second half of the circle runs backwards, so that overflow is the mirror and no
/// position is out of range.
class Texture {
public:
    /// Any size from 2 x 2; the grey values are stretched to the whole of [0, 1], and the image is
    /// resampled to the nearest power of two (at most 1024) in each direction.
    explicit Texture(const Array2<std::uint8_t>& grey);

    double aspect() const { return aspect_; }  ///< width over height of the image given
    int height() const { return height_; }     ///< px, of the image given

    /// A straight walk over the image: point i is at (u + i du, v + i dv).
    struct Walk {
        std::uint32_t u = 0, v = 0, du = 0, dv = 0;
    };
    /// Row y of the map from output pixels to image coordinates ([0, 1] is the image), from x.
    static Walk walk(const Affine& to_image, int x, int y);

    /// Level of detail at which neighbouring output pixels are about one texel apart; 0 is the
    /// image itself.
    float detail(const Affine& to_image) const;

    /// Values in [0, 1], bilinear in the two nearest levels. out.size() is a multiple of 4.
    void sample(const Walk& walk, float detail, std::span<float> out) const;

private:
    struct Level {
        int log2_width = 0, log2_height = 0;
        std::vector<std::uint16_t> texels;  // one mirrored texel around: (width + 2) per row
        int stride() const { return (1 << log2_width) + 2; }
    };
    static Level make_level(const Array2<float>& image);

    double aspect_ = 1;
    int height_ = 0;
    std::vector<Level> levels_;
};

}  // namespace eventide
