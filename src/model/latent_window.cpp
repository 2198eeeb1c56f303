// Times to frame coordinates, and what can be rendered when.
#include "src/model/latent_window.h"

#include <algorithm>

namespace eventide {

std::int64_t LatentWindow::push(const LatentMap& latent) noexcept {
    ++newest_;
    copy_stamp(latent, stamps_[slot(newest_)]);
    return newest_;
}

/// Event windows are (begin, end] each:
///
///     (  k - 1  ](  k  ]  hole  (  k + 1  ]
///               begin of k: the last instant of k - 1; in the hole: k + 1, fraction 0
FramePosition LatentWindow::locate(SensorTime t) const noexcept {
    const std::int64_t oldest = std::max<std::int64_t>(1, newest_ - kLatentsKept + 1);
    for (std::int64_t k = oldest; k <= newest_; ++k) {
        const Window& window = stamp(k).window;
        if (t > window.end) continue;
        // The very first instant of the stream belongs to no window; it is the start of the first.
        if (t < window.begin || (t == window.begin && k > 1)) {
            if (k == oldest) return {};
            return {k, 0};  // a hole between two windows: the later one's beginning
        }
        const auto width = double(window.width().count());
        return {k, width > 0 ? double((t - window.begin).count()) / width : 1};
    }
    return {newest_ + 1, 0};
}

Readiness LatentWindow::readiness(SensorTime t, int lookahead) const noexcept {
    const std::int64_t k = locate(t).k;
    if (k == 0) return Readiness::gone;
    if (k > newest_) return finished_ ? Readiness::gone : Readiness::later;
    // Event window k reads z_{k-2} where its live edge fades: that must still be kept too.
    if (!kept(std::max<std::int64_t>(1, k - 2))) return Readiness::gone;
    if (k + lookahead > newest_ && !finished_) return Readiness::later;
    return Readiness::ready;
}

SensorTime LatentWindow::oldest() const noexcept {
    if (newest_ == 0) return SensorTime::min();
    // Where nothing was dropped yet, the first; else the oldest k whose z_{k-2} is still kept.
    const std::int64_t k = newest_ <= kLatentsKept ? 1 : newest_ - kLatentsKept + 3;
    return stamp(k).window.begin + SensorDuration{k > 1 ? 1 : 0};
}

}  // namespace eventide
