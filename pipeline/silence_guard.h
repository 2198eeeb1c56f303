// What keeps a wrong time in a stream from becoming frames without end.
#pragma once

#include "src/core/sensor_time.h"

#include <cstdint>

namespace eventide {

class SilenceGuard {
public:
    /// Frames of a recording in a row without events: more are times that are wrong (a stamp of 0
    /// before times since 1970), and would fill any disk. 9 hours at 30 frames/s.
    static constexpr std::uint64_t kMost = 1'000'000;

    /// So many frames of a window with so many events come next.
    void open(std::uint64_t events, std::uint64_t frames) noexcept {
        silent_ = events > 0 ? 0 : silent_ + frames;
    }
    bool is_exceeded() const { return silent_ > kMost; }
    /// Throws Error (input): `window` was the last straw. Counts anew.
    [[noreturn]] void refuse(const Window& window);

private:
    std::uint64_t silent_ = 0;
};

}  // namespace eventide
