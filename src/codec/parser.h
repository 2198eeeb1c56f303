// bytes -> events: what every wire and file format gives.
#pragma once

#include "src/core/damage.h"
#include "src/core/event.h"
#include "src/core/sensor_time.h"

#include <cstddef>
#include <optional>
#include <span>

namespace eventide {

/// Reads one stream of bytes, cut anywhere: the same bytes give the same data for any split.
///
/// Bad bytes are counted by reason and left out; parsing goes on at the next safe word. Events come
/// out in non-decreasing time (an event before its predecessor is left out and counted, except
/// across a timestamp reset that the format marks) and inside the sensor.
class Parser {
public:
    virtual ~Parser() = default;

    /// Appends what the bytes complete.
    virtual void parse(std::span<const std::byte> bytes, Batch& into) = 0;

    /// The stream is over: what is still incomplete is counted as truncated.
    virtual void finish(Batch& into) = 0;

    /// Bytes were lost, or the source jumped: drop what is half read and take up at the next safe
    /// word. Counters stay.
    virtual void resync() = 0;

    /// On a live source, before the bytes of each packet: when they arrived. A parser whose wire
    /// format tells only part of the time finds the rest from it after a loss; others need nothing.
    virtual void arrives(HostTime) {}

    /// The newest time the stream has told, by an event or otherwise (time-high words, wraps,
    /// images, IMU): the clock that goes on while nothing moves. Empty before the first.
    virtual std::optional<SensorTime> clock() const = 0;

    virtual const Damage& damaged() const = 0;

    /// As resync(), where the device was opened again: its clock may count from elsewhere. Time
    /// goes on by the host's clock, unless the stream itself says where it begins anew.
    virtual void reopened() { resync(); }
};

}  // namespace eventide
