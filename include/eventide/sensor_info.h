// What a recording or a camera says about its sensor.
#pragma once

#include <cstdint>
#include <string>

namespace eventide {

/// The colours of a sensor's pixels, 2x2 from the top left corner on, row by row.
enum class ColourFilter : std::uint8_t { none, rggb, grbg, gbrg, bggr };

struct SensorInfo {
    std::string name;           ///< "DAVIS346", or what the recording says; may be empty
    std::string serial;         ///< may be empty
    std::string format;         ///< "aedat4", "evt3", "davis", "text", ...
    int width = 0, height = 0;  ///< px; 0 where a recording does not say
    ColourFilter colour_filter = ColourFilter::none;  ///< of a colour camera that says so
};

}  // namespace eventide
