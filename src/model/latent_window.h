// The newest few latent maps, and where a time lies among their event windows.
#pragma once

#include "src/core/frame_data.h"

#include <array>
#include <cstdint>

namespace eventide {

/// Where a time lies: in event window k, at frame coordinate k - 1 + fraction.
struct FramePosition {
    std::int64_t k = 0;
    double fraction = 0;  ///< 0 to 1, linear between the window's edges
};

/// Keeps the stamps of the newest kLatentsKept event windows; whoever keeps the maps themselves
/// puts that of event window k into slot k % kLatentsKept.
///
///     read in window k    z_{k-2}    z_{k-1}    z_k    z_{k+1}    z_{k+2}
///     lookahead 0                    x          x
///     lookahead 1                    x          x      x
///     lookahead 2                    x          x      x          x
///     a fading edge       x          x          x
class LatentWindow {
public:
    /// Lookahead 2 reads z_{k-1} .. z_{k+2}, a live edge that fades z_{k-2} .. z_k.
    static constexpr int kLatentsKept = 5;

    /// A new event window; returns its k.
    std::int64_t push(const LatentMap& latent) noexcept;
    /// No further event window will come: the newest times are at the live edge, whatever lookahead
    /// was asked for.
    void finish() noexcept { finished_ = true; }
    void reset() noexcept { *this = {}; }

    std::int64_t newest() const { return newest_; }
    /// The stamp of event window k, which must be kept.
    const WindowStamp& stamp(std::int64_t k) const { return stamps_[slot(k)]; }
    static std::size_t slot(std::int64_t k) { return std::size_t(k % kLatentsKept); }
    bool kept(std::int64_t k) const { return k >= 1 && k <= newest_ && k > newest_ - kLatentsKept; }
    /// Whether z_j may be read by a frame in event window k (docs/model.md, "lookahead").
    bool known(std::int64_t j, std::int64_t k, int lookahead) const {
        return kept(j) && j <= k + lookahead;
    }

    /// The event window a time lies in, (begin, end]; k = 0 before the first kept one, newest() + 1
    /// after the newest, or where there is none yet.
    FramePosition locate(SensorTime t) const noexcept;
    Readiness readiness(SensorTime t, int lookahead) const noexcept;
    /// The earliest time that is not gone; any where there is no event window yet.
    SensorTime oldest() const noexcept;

private:
    // That of k in slot(k), for newest_ - 4 <= k <= newest_; k counts from 1 since reset().
    std::array<WindowStamp, kLatentsKept> stamps_{};
    std::int64_t newest_ = 0;
    bool finished_ = false;
};

}  // namespace eventide
