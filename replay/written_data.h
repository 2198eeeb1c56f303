// Data as a format can hold them, of a stream that may have clock resets.
#pragma once

#include "replay/formats.h"

#include <cstdint>
#include <string>
#include <vector>

namespace eventide {

/// What a file's format has no record for is left out and counted. Where it cannot say a clock
/// reset (a sender was started again), the times behind it go on from those before: its readers
/// would leave the events out, and a writer may refuse them. Triggers that come behind later events
/// are counted, and mosaics whose colour filter it cannot say are noticed.
class WrittenData {
public:
    /// `colours`: of the sensor that made the images; none where it is not known.
    explicit WrittenData(const FormatHolds& holds, ColourFilter colours = ColourFilter::none)
        : holds_{holds}, colours_{colours} {}

    /// Removes from `batch` what the format cannot hold, and shifts times behind a clock reset that
    /// it cannot say. Call once per batch, in order.
    void fit(Batch& batch);

    const DataCounts& left_out() const { return left_out_; }
    std::uint64_t restarts() const { return restarts_; }  ///< clock resets whose times were shifted
    /// Triggers written with the time of the preceding events.
    std::uint64_t late_triggers() const { return late_triggers_; }

    /// Whether all is in the file, and with its time, unless that was shifted behind a clock reset.
    bool is_whole() const {
        return left_out_ == DataCounts{} && late_triggers_ == 0 &&
               colours_lost_ == ColourFilter::none;
    }
    /// What there is to say of `file`: sentences for people.
    std::vector<std::string> remarks(const std::string& file) const;

    /// Tells people that `file` is of a format that cannot say its images' colour filter.
    static std::string colours_lost_text(const std::string& file, ColourFilter filter);

private:
    static std::string colours_late_text(const std::string& file, ColourFilter filter);
    bool says_colours() const;
    bool begins_anew(SensorTime t, SensorTime newest) const;
    void move(Batch& batch);

    FormatHolds holds_;
    ColourFilter colours_;
    ColourFilter colours_lost_ = ColourFilter::none;  // of images, that the file does not say
    DataCounts left_out_;
    SensorDuration later_{0};                // than the stream says
    SensorTime newest_ = SensorTime::min();  // of the events, as written
    std::uint64_t restarts_ = 0, late_triggers_ = 0;
};

}  // namespace eventide
