// From pixels to the bus: delays, a limited number of events per second, losses, and order.
#pragma once

#include "src/core/event.h"
#include "src/simulate/sensor/sensor_settings.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace eventide {

/// Puts each step's events in order of time. Events of the same microsecond keep the order in which
/// they were given.
class Readout {
public:
    Readout(const SensorTraits& traits, std::size_t pixels, Random random)
        : traits_(traits), bus_hz_(traits.arbiter_hz_per_pixel * double(pixels)), random_(random) {}

    /// Takes the events of (begin, end], in any order, and appends those that are certain to have
    /// none before them any more. Delayed ones come with a later step.
    void take(SensorTime begin, SensorTime end, std::vector<Event>& events,
              std::vector<Event>& out);

    std::uint64_t dropped() const { return dropped_; }  ///< lost on the way or for want of room

private:
    void delay(std::vector<Event>& events);
    void pass(const Event& event, std::vector<Event>& out);

    SensorTraits traits_;
    double bus_hz_;  // 0: without limit
    Random random_;
    std::vector<Event> waiting_;  // delayed beyond the steps taken so far
    std::vector<Event> sorted_;
    std::vector<std::uint32_t> starts_;
    double bus_free_us_ = -1e18;
    std::uint64_t dropped_ = 0;
};

}  // namespace eventide
