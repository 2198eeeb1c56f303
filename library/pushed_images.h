// Images of cameras and of callers, before they correct frames.
#pragma once

#include <eventide/event.h>

#include <vector>

namespace eventide {

/// Throws Error (usage) for an image whose numbers contradict each other, or that lies beyond every
/// sensor. One without pixels tells its time alone.
void check_image(const ReferenceImage& image);

/// A mosaic in grey: a quarter of red, half of green, a quarter of blue around each pixel. Images
/// that are none, or do not say so (ReferenceImage::filter), stay as they are.
ReferenceImage without_mosaic(const ReferenceImage& image);

/// Says of images of one channel that they are mosaics of the sensor's `filter`, where they do not
/// say. Also of those of a part: filters count from the sensor's corner.
void tell_filter(ColourFilter filter, std::vector<ReferenceImage>& images);

}  // namespace eventide
