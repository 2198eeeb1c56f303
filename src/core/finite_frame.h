// Whether a network's frame holds numbers, and what is said of one that does not.
#pragma once

#include "src/core/array.h"
#include "src/core/error.h"

#include <eventide/frame.h>

#include <string>

namespace eventide {

/// Intensity and sigma; colours, which few frames have, are asked for apart.
inline bool is_finite(const Frame& frame) {
    return is_finite(frame.intensity) && is_finite(frame.sigma);
}

/// Throws Error (input) naming the frame. A state that has a NaN keeps it, so no later frame will
/// be better.
[[noreturn]] inline void refuse_not_finite(const std::string& frame) {
    throw Error(ErrorKind::input, frame +
                                      ": expected finite numbers of the network, found NaN or "
                                      "infinity: its weights or its state are damaged");
}

}  // namespace eventide
