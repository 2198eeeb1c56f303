// Delays, arbitration and sorting.
#include "src/simulate/sensor/readout.h"

#include <algorithm>
#include <cmath>

namespace eventide {

void Readout::delay(std::vector<Event>& events) {
    if (traits_.jitter_s > 0)
        for (Event& event : events)
            event.t += SensorDuration{std::int64_t(traits_.jitter_s * 1e6 * random_.exponential())};
    if (traits_.dropped > 0)
        dropped_ +=
            std::erase_if(events, [&](const Event&) { return random_.chance(traits_.dropped); });
}

/// One event after the other over the bus.
void Readout::pass(const Event& event, std::vector<Event>& out) {
    if (bus_hz_ <= 0) {
        out.push_back(event);
        return;
    }
    const double t = double(to_us(event.t)), start = std::max(t, bus_free_us_);
    if (start - t > traits_.arbiter_wait_s * 1e6) {
        ++dropped_;
        return;
    }
    bus_free_us_ = start + 1e6 / bus_hz_;
    out.push_back(event);
    out.back().t = from_us(std::int64_t(start));
}

void Readout::take(SensorTime begin, SensorTime end, std::vector<Event>& events,
                   std::vector<Event>& out) {
    delay(events);
    events.insert(events.begin(), waiting_.begin(), waiting_.end());
    waiting_.clear();
    // A counting sort: a step has few microseconds and often many events.
    const auto slot = [&](const Event& e) { return std::size_t((e.t - begin).count() - 1); };
    starts_.assign(std::size_t((end - begin).count()) + 1, 0);
    for (const Event& event : events)
        if (event.t <= end)
            ++starts_[slot(event) + 1];
        else
            waiting_.push_back(event);
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    sorted_.resize(starts_.back());
    for (const Event& event : events)
        if (event.t <= end) sorted_[starts_[slot(event)]++] = event;
    for (const Event& event : sorted_) pass(event, out);
}

}  // namespace eventide
