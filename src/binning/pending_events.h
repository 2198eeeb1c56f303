// Events that are in no event window yet.
#pragma once

#include "src/core/event.h"

#include <cstddef>
#include <span>
#include <vector>

namespace eventide {

/// In the order of the stream, in segments: a new one begins where the camera's clock was reset,
/// and within each one times ascend. Memory is freed only by drop_taken(), so what was taken can be
/// borrowed until then.
class PendingEvents {
public:
    void push(const Event& event) { events_.push_back(event); }

    /// The clock was reset after what was pushed: the segment's time ended at `final`, and that of
    /// the next begins at `begin`.
    void end_segment(SensorTime final, SensorTime begin) {
        ends_.push_back({events_.size(), final, begin});
    }

    /// What is left of the oldest segment.
    std::span<const Event> segment() const;
    bool segment_has_ended() const { return !ends_.empty(); }         ///< nothing more comes to it
    SensorTime segment_final() const { return ends_.front().final; }  ///< of one that has ended

    /// Takes the oldest segment's events up to `end`, inclusive.
    std::span<const Event> take_until(SensorTime end);
    /// The oldest segment has ended and all of it was taken. Returns where the next begins.
    SensorTime next_segment();

    void drop_taken();
    void clear() { assign({}); }
    void assign(std::span<const Event> events);  ///< of one segment, instead of what was there

private:
    struct End {
        std::size_t index;  // of the next segment's first event
        SensorTime final, begin;
    };
    std::vector<Event> events_;  // from taken_ on not taken yet
    std::size_t taken_ = 0;
    std::vector<End> ends_;
};

}  // namespace eventide
