// Images of sensors with a colour filter, in colour.
#pragma once

#include "src/core/event.h"

namespace eventide {

/// A mosaic as BGR; images that are none stay as they are. An image that says its own filter is
/// taken at its word where `filter` is none.
ReferenceImage demosaiced(const ReferenceImage& image, ColourFilter filter);

}  // namespace eventide
