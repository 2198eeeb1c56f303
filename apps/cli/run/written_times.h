// Times as a format can hold them, of a stream whose clock may begin anew.
#pragma once

#include "replay/formats.h"

#include <cstdint>
#include <string>
#include <vector>

namespace eventide::app {

/// Where the format of a file cannot say that the sensor's clock began anew (a sender was started
/// again), the times behind it go on from those before: its readers would leave the events out, and
/// a writer may refuse them. Triggers that come behind later events are counted.
class WrittenTimes {
public:
    explicit WrittenTimes(const FormatHolds& holds) : holds_{holds} {}

    /// Of a batch as it is written, one after the other.
    void put_in_order(Batch& batch);

    std::uint64_t restarts() const { return restarts_; }  ///< of the clock, that were moved
    /// That the file holds with the time of the events before them.
    std::uint64_t late_triggers() const { return late_triggers_; }

    /// What there is to say of `file`: sentences for people.
    std::vector<std::string> remarks(const std::string& file) const;

private:
    bool begins_anew(SensorTime t, SensorTime newest) const;
    void move(Batch& batch);

    const FormatHolds holds_;
    SensorDuration later_{0};                // than the stream says
    SensorTime newest_ = SensorTime::min();  // of the events, as written
    std::uint64_t restarts_ = 0, late_triggers_ = 0;
};

}  // namespace eventide::app
