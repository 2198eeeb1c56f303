// A network that begins with what another has learned, where the two agree.
#pragma once

#include "apps/train/network/parameters.h"

#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

/// Copies into `parameters` what a model file or a checkpoint (its running mean) has under the same
/// name and in the same shape; the rest stays as it is, but that a new level's join ("up.L") lets
/// its own level through at first, so that what lies above it finds nearly what it learned with.
/// An encoder whose every layer the file has, some with fewer channels, computes at first what that
/// one did: the new channels begin at random and nothing that was learned reads them yet.
/// Returns the names that were not inherited. Throws Error(input).
std::vector<std::string> warm_start(const std::filesystem::path& path, Parameters& parameters);

}  // namespace eventide
