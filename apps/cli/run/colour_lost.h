// Formats in which mosaics lose their colour filter, and come back as grey images.
#pragma once

#include "replay/formats.h"
#include "src/core/bayer.h"

#include <string>

namespace eventide::app {

/// For people; empty where nothing is lost. `format`: null for a folder. AEDAT 3 says the filter
/// with each image, AEDAT 4 at its beginning.
inline std::string colour_lost_text(const std::string& file, const Format* format,
                                    ColourFilter filter) {
    const bool has_images = format == nullptr || format->holds.images;
    const bool says_it =
        format != nullptr && (format->name == "aedat3" || format->name == "aedat4");
    if (filter == ColourFilter::none || !has_images || says_it) return {};
    return file + ": its format cannot say the images' colour filter, " +
           std::string{name_of(filter)} + ": --bayer states it";
}

}  // namespace eventide::app
