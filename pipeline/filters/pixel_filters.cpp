// Filters that remember what each pixel did.
#include "pipeline/filters/pixel_filters.h"

#include <algorithm>

namespace eventide {

bool TimesOfPixels::is_recent(int x, int y, SensorTime t, SensorDuration within) const {
    return eventide::is_recent(times_[std::size_t(y) * std::size_t(width_) + std::size_t(x)], t,
                               within);
}

void TimesOfPixels::set(int x, int y, SensorTime t) {
    times_[std::size_t(y) * std::size_t(width_) + std::size_t(x)] = t;
}

void RefractoryFilter::process(Batch& batch) {
    std::erase_if(batch.events, [this](const Event& event) {
        // Exactly so much later is late enough.
        if (last_.is_recent(event.x, event.y, event.t, time_ - SensorDuration{1})) return true;
        last_.set(event.x, event.y, event.t);
        return false;
    });
}

bool BackgroundActivityFilter::is_supported(const Event& event) const {
    int found = 0;
    const int left = std::max(0, event.x - radius_),
              right = std::min(newest_.width() - 1, event.x + radius_);
    for (int y = std::max(0, event.y - radius_);
         y <= std::min(newest_.height() - 1, event.y + radius_); ++y)
        for (int x = left; x <= right; ++x)
            if ((x != event.x || y != event.y) && newest_.is_recent(x, y, event.t, time_) &&
                ++found == support_)
                return true;
    return false;
}

void BackgroundActivityFilter::process(Batch& batch) {
    std::erase_if(batch.events, [this](const Event& event) {
        const bool supported = is_supported(event);
        newest_.set(event.x, event.y, event.t);
        return !supported;
    });
}

}  // namespace eventide
