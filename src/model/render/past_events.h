// How many events came since a time that is not long past.
#pragma once

#include "src/core/array.h"
#include "src/core/sensor_time.h"

#include <array>
#include <cstddef>
#include <optional>

namespace eventide {

/// Events per pixel of the last 200 ms, so that an image that comes late can be told what came
/// since. One thread at a time; nothing is allocated after construction, nothing fails.
class PastEvents {
public:
    static constexpr SensorDuration kRemembered{200'000};

    PastEvents(int width, int height);

    void reset() noexcept;

    /// The next event window, and its events per pixel, [y][x].
    void remember(const Window& window, const Array2<float>& events) noexcept;

    /// Adds `weight` times the events per pixel since t, which are taken to have come evenly within
    /// 20 ms, and before the first window as often as since then.
    void add_since(SensorTime t, float weight, Array2<float>& sum) const noexcept;

private:
    struct Slot {
        Window window{};
        Array2<float> events;
    };
    // A ring: the newest slot is filled until it is 18.2 ms wide, then the oldest begins anew.
    std::array<Slot, 12> slots_;
    std::size_t newest_ = 0;
    std::optional<Window> all_;  // from the first window's begin to the newest's end
};

}  // namespace eventide
