// How many events came since a time that is not long past.
#include "src/model/render/past_events.h"

#include "src/model/render/half_maps.h"

#include <algorithm>

namespace eventide {
namespace {

// Each slot takes at least this long: 11 whole ones are 200.2 ms, beside the one that is being
// filled.
constexpr SensorDuration kSlot{18'200};

}  // namespace

PastEvents::PastEvents(int width, int height) {
    for (Slot& slot : slots_) slot.events = Array2<float>(height, width);
}

void PastEvents::reset() noexcept {
    for (Slot& slot : slots_) slot.window = {};
    all_.reset();
}

void PastEvents::remember(const Window& window, const Array2<float>& events) noexcept {
    if (slots_[newest_].window.width() >= kSlot || !all_) {
        newest_ = (newest_ + 1) % slots_.size();
        slots_[newest_].window = {window.begin, window.begin};
        fill(slots_[newest_].events, 0);
    }
    all_ = {all_ ? all_->begin : window.begin, window.end};
    Slot& slot = slots_[newest_];
    slot.window.end = window.end;
    for (std::size_t i = 0; i < slot.events.values().size(); ++i)
        slot.events.values()[i] += events.values()[i];
}

void PastEvents::add_since(SensorTime t, float weight, Array2<float>& sum) const noexcept {
    if (const double known = all_ ? double(all_->width().count()) : 0; known > 0 && t < all_->begin)
        weight *= float(double((all_->end - t).count()) / known);
    for (const Slot& slot : slots_) {
        const double width = double(slot.window.width().count());
        if (width <= 0 || slot.window.end <= t) continue;
        const float share =
            weight * float(std::min(1., double((slot.window.end - t).count()) / width));
        for (std::size_t i = 0; i < sum.values().size(); ++i)
            sum.values()[i] += share * slot.events.values()[i];
    }
}

}  // namespace eventide
