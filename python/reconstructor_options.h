// What Python says of frames, as options of the library.
#pragma once

#include <eventide/reconstructor.h>

#include <pybind11/pybind11.h>

#include <array>
#include <optional>
#include <string>
#include <utility>

namespace eventide::python {

using Size = std::optional<std::pair<int, int>>;  ///< width, height; px
using Roi = std::optional<std::array<int, 4>>;    ///< x, y, width, height; px

/// What is not given is as in `otherwise`. Throws Error (usage) for a size below 1.
FrameSize size_of(const Size& size, const Roi& roi, FrameSize otherwise = {});

/// A number of frames per second, or a text as the library takes it. Throws TypeError.
std::string rate_of(const pybind11::handle& fps);

}  // namespace eventide::python
