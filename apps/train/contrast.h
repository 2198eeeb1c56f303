// More contrast for a network that has learned to be careful.
#pragma once

#include "src/model/model_file.h"

namespace eventide {

/// A network that cannot know how much light a change of it stands for paints frames greyer than
/// the scene: the mean over what it could have been. Intensity becomes
/// around + gain (intensity - around), by the last layer's weights: nothing else of the network
/// changes, sigma neither. `gain` > 0, finite; `around` in units of intensity, [0, 1]. Throws
/// Error(usage) for others.
void stretch_contrast(Model& model, double gain, double around);

}  // namespace eventide
