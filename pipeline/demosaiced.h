// Images of sensors with a colour filter, in colour.
#pragma once

#include "src/core/event.h"

#include <optional>

namespace eventide {

/// A mosaic as BGR; images that are none, of which `filter` may be one, stay as they are. Without
/// `filter` an image is taken at its word.
ReferenceImage demosaiced(ReferenceImage image, std::optional<ColourFilter> filter);

/// `filter` as demosaiced() takes it: none says something only where somebody stated it.
std::optional<ColourFilter> told_filter(ColourFilter filter, bool is_stated);

}  // namespace eventide
