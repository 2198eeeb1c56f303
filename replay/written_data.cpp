// Data as a format can hold them.
#include "replay/written_data.h"

#include "src/codec/batch_parts.h"
#include "src/core/bayer.h"
#include "src/core/number_text.h"

#include <algorithm>

namespace eventide {

namespace {

std::string times_text(std::uint64_t n) {
    return n == 1 ? "once" : std::to_string(n) + " times";
}

/// Adds `before` to times of the stream that ended, `after` to those of the one that begins.
struct Seam {
    SensorTime last, first;  // event
    SensorDuration before, after;

    template <typename T>
    void move(std::vector<T>& items) const {
        for (T& item : items) item.t += is_of_new_clock(item.t, last, first) ? after : before;
    }
};

}  // namespace

void WrittenData::fit(Batch& batch) {
    left_out_ += remove_not_held(batch, holds_);
    if (!says_colours())
        for (const ReferenceImage& image : batch.images)
            if (image.channels == 1 && colours_lost_ == ColourFilter::none)
                colours_lost_ = colours_ != ColourFilter::none ? colours_ : image.filter;
    const SensorTime written = newest_;
    if (!holds_.clock_resets) move(batch);
    if (holds_.in_time_order)
        late_triggers_ += std::uint64_t(std::ranges::count_if(
            batch.triggers, [&](const Trigger& trigger) { return trigger.t < written; }));
    if (!batch.events.empty()) newest_ = batch.events.back().t;
}

bool WrittenData::says_colours() const {
    return holds_.colour_filter_of_each || (holds_.colour_filter && colours_ != ColourFilter::none);
}

bool WrittenData::begins_anew(SensorTime t, SensorTime newest) const {
    // EVT3's longest; a leap from a clock of its own to one that counts from 1970 is 50 years.
    constexpr SensorDuration kLongestGap = std::chrono::hours{240};
    const bool leaps =
        holds_.in_time_order && newest != SensorTime::min() && t > newest + kLongestGap;
    return t < newest || leaps;
}

void WrittenData::move(Batch& batch) {
    constexpr SensorDuration kMicrosecond{1};
    SensorTime newest = newest_;
    Seam seam{newest, newest, later_, later_};
    for (Event& event : batch.events) {
        if (begins_anew(event.t + later_, newest)) {
            seam = {newest - later_, event.t, later_, newest + kMicrosecond - event.t};
            later_ = seam.after;
            ++restarts_;
        }
        newest = event.t += later_;
    }
    if (later_ == SensorDuration{0}) return;
    seam.move(batch.images);
    seam.move(batch.imu);
    seam.move(batch.triggers);
}

std::vector<std::string> WrittenData::remarks(const std::string& file) const {
    std::vector<std::string> remarks;
    if (!(left_out_ == DataCounts{}))
        remarks.push_back(file + ": left out what its format cannot hold: " + text_of(left_out_));
    if (restarts_ > 0)
        remarks.push_back(file + ": the clock began anew " + times_text(restarts_) +
                          ", which its format cannot say: the times behind it go on from those "
                          "before");
    if (late_triggers_ > 0)
        remarks.push_back(file + ": " + counted(late_triggers_, "trigger") +
                          " came behind later events and have the time of those");
    if (colours_lost_ != ColourFilter::none)
        remarks.push_back(holds_.colour_filter ? colours_late_text(file, colours_lost_)
                                               : colours_lost_text(file, colours_lost_));
    return remarks;
}

std::string WrittenData::colours_lost_text(const std::string& file, ColourFilter filter) {
    return file + ": its format cannot say the images' colour filter, " +
           std::string{name_of(filter)} + ": --bayer states it";
}

std::string WrittenData::colours_late_text(const std::string& file, ColourFilter filter) {
    return file + ": its format says the images' colour filter before the first of them, which " +
           "told it, " + std::string{name_of(filter)} + ": --bayer states it";
}

}  // namespace eventide
