// A batch cut by time, so that what is written kind by kind lies near the other data of its time.
#pragma once

#include "src/core/event.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <iterator>
#include <span>
#include <utility>
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

/// Whether data at `t` come after a clock reset, which lies between an event at `last` and the next
/// one at `first`: they have no place among the events, so they go with the nearer of the two.
inline bool is_of_new_clock(SensorTime t, SensorTime last, SensorTime first) {
    return std::chrono::abs(t - first) < std::chrono::abs(t - last);
}

/// Takes off `rest` what comes before the first clock reset (an event is earlier than the one
/// before it), or all where there is none. Images, samples and triggers as is_of_new_clock() says.
inline BatchPart take_clock(BatchPart& rest) {
    const auto back = std::ranges::adjacent_find(
        rest.events, [](const Event& a, const Event& b) { return b.t < a.t; });
    if (back == rest.events.end()) return std::exchange(rest, {});
    const SensorTime last = back->t, first = std::next(back)->t;
    const auto take = [&](auto& items) {
        const auto end = std::ranges::find_if(
            items, [&](const auto& item) { return is_of_new_clock(item.t, last, first); });
        const auto taken = items.first(std::size_t(end - items.begin()));
        items = items.subspan(taken.size());
        return taken;
    };
    const auto events = rest.events.first(std::size_t(std::next(back) - rest.events.begin()));
    rest.events = rest.events.subspan(events.size());
    return {events, take(rest.images), take(rest.imu), take(rest.triggers)};
}

/// take(BatchPart) for all of the batch, kLongestPart at a time, never across a clock reset. Events
/// alone are one part: nothing else could come too late.
template <typename Take>
void in_parts(const Batch& batch, Take&& take) {
    const auto is_empty = [](const BatchPart& part) {
        return part.events.empty() && part.images.empty() && part.imu.empty() &&
               part.triggers.empty();
    };
    BatchPart all{batch.events, batch.images, batch.imu, batch.triggers};
    if (batch.images.empty() && batch.imu.empty() && batch.triggers.empty()) {
        if (!is_empty(all)) take(all);
        return;
    }
    while (!is_empty(all)) {
        BatchPart rest = take_clock(all);
        while (!is_empty(rest)) {
            SensorTime first = SensorTime::max();
            const auto look = [&](const auto& items) {
                if (!items.empty()) first = std::min(first, items.front().t);
            };
            look(rest.events);
            look(rest.images);
            look(rest.imu);
            look(rest.triggers);
            const SensorTime last =
                std::min(first, SensorTime::max() - kLongestPart) + kLongestPart;
            take(BatchPart{take_until(rest.events, last), take_until(rest.images, last),
                           take_until(rest.imu, last), take_until(rest.triggers, last)});
        }
    }
}

}  // namespace eventide
