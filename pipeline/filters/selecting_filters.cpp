// Filters that look at one event at a time.
#include "pipeline/filters/selecting_filters.h"

namespace eventide {

void RegionFilter::process(Batch& batch) {
    std::erase_if(batch.events, [this](const Event& event) {
        return event.x < left_ || event.x >= right_ || event.y < top_ || event.y >= bottom_;
    });
}

void PolarityFilter::process(Batch& batch) {
    std::erase_if(batch.events, [this](const Event& event) { return event.polarity != kept_; });
}

void EveryNthFilter::process(Batch& batch) {
    std::erase_if(batch.events, [this](const Event&) { return seen_++ % n_ != 0; });
}

/// Before the first event there is nothing to count from: images and others of that time go where
/// a beginning was asked for.
bool TimeFilter::is_inside(SensorTime t) const {
    const auto time_of = [this](const TimePoint& point) {
        return point.absolute ? SensorTime{point.value} : *first_ + point.value;
    };
    const bool known = first_.has_value();
    if (from_ && (from_->absolute || known) && t < time_of(*from_)) return false;
    if (from_ && !from_->absolute && !known) return false;
    return !to_ || (!to_->absolute && !known) || t <= time_of(*to_);
}

void TimeFilter::process(Batch& batch) {
    const auto outside = [this](const auto& item) { return !is_inside(item.t); };
    std::erase_if(batch.events, outside);
    std::erase_if(batch.images, outside);
    std::erase_if(batch.imu, outside);
    std::erase_if(batch.triggers, outside);
}

}  // namespace eventide
