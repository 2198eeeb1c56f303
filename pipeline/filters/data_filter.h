// One filter of those that a user chains (--filter).
#pragma once

#include "src/core/event.h"

#include <eventide/event.h>

#include <memory>
#include <string>
#include <vector>

namespace eventide {

struct SensorPixels {
    int width = 0, height = 0;  ///< px
    friend bool operator==(const SensorPixels&, const SensorPixels&) = default;
};

/// Leaves out some of the data, or puts them elsewhere; their order stays. What becomes of an event
/// depends on the events before it, not on how they are split into batches. One thread at a time.
class DataFilter {
public:
    virtual ~DataFilter() = default;
    virtual void process(Batch& batch) = 0;
    /// When the recording's first event was; told before the first events are processed.
    virtual void count_from(SensorTime) {}
    /// Size of the sensor as it looks behind the filter.
    virtual SensorPixels size() const = 0;
    /// The colour filter before its pixels as they lie behind this one; none where what is left of
    /// them is no such pattern.
    virtual ColourFilter pattern(ColourFilter before) const { return before; }
};

/// "NAME" or "NAME:ARGUMENTS", for data of a sensor of that size:
///   region:X,Y,WxH              what lies in it
///   polarity:on|off
///   subsample:N                 each N-th event, beginning with the first
///   subsample:NxM               each N-th column and M-th row, brought together
///   refractory:TIME             not within TIME after the last event of that pixel that stayed
///   background-activity:TIME[,R[,N]]  where N (1) other pixels not farther than R (1) px had one
///                               within TIME
///   hot-pixels:learn|FILE       as HotPixelFilter
///   flicker[:LOW..HIGH]         of pixels that do not flicker at LOW..HIGH (50..500) Hz
///   flip:x|y                    mirrored left to right, or upside down
///   transpose                   rows become columns
///   time:FROM..TO               as 1s..2.5s after the first event or @US..@US; either may be empty
/// Throws Error (usage) naming what was expected and what was found.
std::unique_ptr<DataFilter> make_data_filter(const std::string& text, const SensorPixels& size);

/// What make_data_filter() takes, for help: "region:X,Y,WxH, polarity:on|off, ...".
std::string data_filter_names();

}  // namespace eventide
