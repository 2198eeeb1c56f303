// The environment of the process.
#pragma once

#include <cstdlib>

namespace eventide {

/// The variable's value, or null where it is not set. Any thread: nothing here changes the
/// environment, and what a program around the library changes it must change before.
inline const char* environment_value(const char* name) {
    return std::getenv(name);  // NOLINT(concurrency-mt-unsafe)
}

}  // namespace eventide
