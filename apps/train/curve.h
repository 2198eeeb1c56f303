// The learning curve as an image.
#pragma once

#include <filesystem>

namespace eventide {

/// An SVG of the training log (thin) and the validations (dots), one panel per measure. Missing or
/// short files give an empty plot. Throws Error(failed) where it cannot be written.
void write_curve(const std::filesystem::path& svg, const std::filesystem::path& log,
                 const std::filesystem::path& validation);

}  // namespace eventide
