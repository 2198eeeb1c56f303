// Colour filters of sensors: which pixel sees which colour.
#pragma once

#include "src/core/array.h"
#include "src/core/event.h"

#include <eventide/event.h>

#include <array>
#include <cassert>
#include <cstdint>
#include <optional>
#include <string_view>

namespace eventide {

/// A place in a square of 2x2 pixels that begins at even x and y.
struct BayerSite {
    int x = 0, y = 0;  ///< 0 or 1 each
};

/// As Frame::colour orders them.
enum class ColourChannel : std::uint8_t { blue, green, red };

inline constexpr std::array kColourFilters{ColourFilter::none, ColourFilter::rggb,
                                           ColourFilter::grbg, ColourFilter::gbrg,
                                           ColourFilter::bggr};

constexpr std::string_view name_of(ColourFilter filter) {
    switch (filter) {
        case ColourFilter::rggb:
            return "rggb";
        case ColourFilter::grbg:
            return "grbg";
        case ColourFilter::gbrg:
            return "gbrg";
        case ColourFilter::bggr:
            return "bggr";
        case ColourFilter::none:
            break;
    }
    return "none";
}

/// What libcaer, AEDAT 3 and AEDAT 4 number 0 to 4 (docs/protocols.md, A.4, D.2, D.3): RGBG, GRGB,
/// GBGR and BGRG there, which go round the square, so that the third letter lies below the second.
/// Empty for other numbers.
inline std::optional<ColourFilter> colour_filter_of_number(std::uint32_t number) {
    if (number > std::uint32_t(ColourFilter::bggr)) return std::nullopt;
    return ColourFilter(number);
}
inline std::uint32_t number_of(ColourFilter filter) {
    return std::uint32_t(filter);
}

/// Where the filter, which is not none, has red; blue lies across from it.
constexpr BayerSite red_of(ColourFilter filter) {
    assert(filter != ColourFilter::none);
    switch (filter) {
        case ColourFilter::grbg:
            return {1, 0};
        case ColourFilter::gbrg:
            return {0, 1};
        case ColourFilter::bggr:
            return {1, 1};
        default:
            return {0, 0};
    }
}

/// The filter is not none.
constexpr ColourChannel channel_at(ColourFilter filter, int x, int y) {
    const BayerSite red = red_of(filter);
    const bool column = (x & 1) == red.x, row = (y & 1) == red.y;
    if (column != row) return ColourChannel::green;
    return column ? ColourChannel::red : ColourChannel::blue;
}

/// The filter of a sensor whose pixel (x, y) sees channel(x, y) in its first square; none where no
/// filter has it so.
template <typename Channel>
ColourFilter filter_with(const Channel& channel) {
    for (const ColourFilter filter :
         {ColourFilter::rggb, ColourFilter::grbg, ColourFilter::gbrg, ColourFilter::bggr}) {
        bool same = true;
        for (int at = 0; at < 4; ++at)
            same = same && channel_at(filter, at & 1, at >> 1) == channel(at & 1, at >> 1);
        if (same) return filter;
    }
    return ColourFilter::none;
}

/// The filter of an image whose top left corner is the sensor's pixel (x0, y0). The filter is not
/// none.
inline ColourFilter filter_at(ColourFilter filter, int x0, int y0) {
    return filter_with([&](int x, int y) { return channel_at(filter, x0 + x, y0 + y); });
}

/// Where the colour is; of green, the one in red's row. The filter is not none.
inline BayerSite site_of(ColourFilter filter, ColourChannel channel) {
    const BayerSite red = red_of(filter);
    switch (channel) {
        case ColourChannel::blue:
            return {1 - red.x, 1 - red.y};
        case ColourChannel::green:
            return {1 - red.x, red.y};
        default:
            return red;
    }
}

/// The pixels of one site as an image of their own, at half the place and size: of a mosaic, or of
/// the channel of a BGR image. Empty where the image holds none of them.
inline std::optional<ReferenceImage> image_of_site(const ReferenceImage& mosaic,
                                                   const BayerSite& site, ColourChannel channel) {
    const int stride = mosaic.channels, shift = stride >= 3 ? int(channel) : 0;
    // The first of the site in the image, whose corner may lie on any.
    const int left = (site.x + mosaic.x0) & 1, top = (site.y + mosaic.y0) & 1;
    const int columns = (mosaic.pixels.width() / stride - left + 1) / 2;
    const int rows = (mosaic.pixels.height() - top + 1) / 2;
    if (columns < 1 || rows < 1) return std::nullopt;
    ReferenceImage image;
    image.t = mosaic.t;
    image.exposure_begin = mosaic.exposure_begin;
    image.exposure_end = mosaic.exposure_end;
    // Even numbers, so that what begins beyond the sensor's corner is not rounded towards it.
    image.x0 = (mosaic.x0 + left - site.x) / 2;
    image.y0 = (mosaic.y0 + top - site.y) / 2;
    image.pixels = Array2<std::uint16_t>(rows, columns);
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            image.pixels(y, x) = mosaic.pixels(top + 2 * y, (left + 2 * x) * stride + shift);
    return image;
}

}  // namespace eventide
