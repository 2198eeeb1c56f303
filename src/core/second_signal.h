// When a further signal is another wish than the first.
#pragma once

#include <signal.h>

#include <atomic>
#include <chrono>
#include <cstdint>

namespace eventide {

/// How long SIGINT and SIGTERM count as the first signal.
inline constexpr std::chrono::milliseconds kOneWish{500};

/// Whether a signal that comes so long after the first is the same wish to stop, and no second one:
/// timeout(1) signals the program and then its whole group, and a terminal that closes hangs up
/// more than once (the shell and the kernel do).
inline bool repeats_the_first(int number, std::chrono::nanoseconds after_the_first) {
    return number == SIGHUP || after_the_first < kOneWish;
}

/// What a signal to stop says to a handler that has seen those before it.
enum class StopWish { first, repeated, second };

/// Remembers when the first signal came. take() and came() may be called from handlers and from any
/// thread.
class FirstSignal {
public:
    StopWish take(int number) noexcept {
        using namespace std::chrono;
        const std::int64_t now = nanoseconds{steady_clock::now().time_since_epoch()}.count();
        std::int64_t first = kNone;
        if (first_.compare_exchange_strong(first, now)) return StopWish::first;
        return repeats_the_first(number, nanoseconds{now - first}) ? StopWish::repeated
                                                                   : StopWish::second;
    }
    bool came() const noexcept { return first_ != kNone; }
    void forget() noexcept { first_ = kNone; }

private:
    static constexpr std::int64_t kNone = 0;
    static_assert(std::atomic<std::int64_t>::is_always_lock_free);  // for handlers

    std::atomic<std::int64_t> first_{kNone};  // ns of the steady clock, which handlers may read
};

}  // namespace eventide
