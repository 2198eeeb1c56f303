// The message of a silence that is too long.
#include "pipeline/silence_guard.h"

#include "src/core/error.h"

#include <chrono>
#include <cstdio>
#include <string>
#include <utility>

namespace eventide {

void SilenceGuard::refuse(const Window& window) {
    const double hours =
        std::chrono::duration<double, std::ratio<3600>>(window.end - window.begin).count();
    char length[32];
    std::snprintf(length, sizeof length, "%.1f", hours);
    throw Error(ErrorKind::input, "no events from " + std::to_string(to_us(window.begin)) + " to " +
                                      std::to_string(to_us(window.end)) + " us (" + length +
                                      " hours): expected at most " + std::to_string(kMost) +
                                      " frames in a row without events, found " +
                                      std::to_string(std::exchange(silent_, 0)) +
                                      "; choose a part of the stream, fewer frames per second, or "
                                      "allow the silence (--allow-silence, allow_silence)");
}

}  // namespace eventide
