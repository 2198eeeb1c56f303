// Somebody wants the run to end: what is in work may be finished, for a while.
#pragma once

#include <atomic>
#include <chrono>

namespace eventide {

/// Thread: any, also a signal-waiting one.
class StopRequest {
public:
    void set() noexcept {
        using Clock = std::chrono::steady_clock;
        Clock::rep not_yet = 0;
        const Clock::rep now = Clock::now().time_since_epoch().count();
        since_.compare_exchange_strong(not_yet, now == 0 ? 1 : now, std::memory_order_relaxed);
    }
    bool is_set() const noexcept { return since_.load(std::memory_order_relaxed) != 0; }

    /// What is still in work is not worth waiting for: an hour of silence at 1000 frames per
    /// second, a sink that has stalled.
    bool is_overdue() const noexcept {
        using Clock = std::chrono::steady_clock;
        const Clock::rep since = since_.load(std::memory_order_relaxed);
        return since != 0 && Clock::now().time_since_epoch() - Clock::duration{since} > kGrace;
    }

private:
    static constexpr std::chrono::seconds kGrace{1};
    std::atomic<std::chrono::steady_clock::rep> since_{0};  // 0: not set
};

}  // namespace eventide
