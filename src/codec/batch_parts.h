// A batch cut by time, so that what is written kind by kind lies near the other data of its time.
#pragma once

#include "src/core/event.h"

#include <algorithm>
#include <chrono>
#include <span>
#include <vector>

namespace eventide {

/// Some of a batch, in its order.
struct BatchPart {
    std::span<const Event> events;
    std::span<const ReferenceImage> images;
    std::span<const ImuSample> imu;
    std::span<const Trigger> triggers;
};

/// What cameras put in a packet. Whoever reads waits half a second for images behind the events of
/// their time, and a batch of a quiet scene lasts longer.
constexpr SensorDuration kLongestPart = std::chrono::milliseconds(10);

/// The items up to the first that is later than `last`.
template <typename T>
std::span<const T> take_until(std::span<const T>& items, SensorTime last) {
    const auto end = std::ranges::find_if(items, [&](const T& item) { return item.t > last; });
    const auto n = std::size_t(end - items.begin());
    const auto taken = items.first(n);
    items = items.subspan(n);
    return taken;
}

/// take(BatchPart) for all of the batch, kLongestPart at a time. Events alone are one part: nothing
/// else could come too late.
template <typename Take>
void in_parts(const Batch& batch, Take&& take) {
    BatchPart rest{batch.events, batch.images, batch.imu, batch.triggers};
    if (batch.images.empty() && batch.imu.empty() && batch.triggers.empty()) {
        if (!batch.events.empty()) take(rest);
        return;
    }
    const auto none_left = [&] {
        return rest.events.empty() && rest.images.empty() && rest.imu.empty() &&
               rest.triggers.empty();
    };
    while (!none_left()) {
        SensorTime first = SensorTime::max();
        const auto look = [&](const auto& items) {
            if (!items.empty()) first = std::min(first, items.front().t);
        };
        look(rest.events);
        look(rest.images);
        look(rest.imu);
        look(rest.triggers);
        const SensorTime last = std::min(first, SensorTime::max() - kLongestPart) + kLongestPart;
        take(BatchPart{take_until(rest.events, last), take_until(rest.images, last),
                       take_until(rest.imu, last), take_until(rest.triggers, last)});
    }
}

}  // namespace eventide
