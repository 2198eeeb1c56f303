// When a further signal is another wish than the first.
#pragma once

#include <signal.h>

#include <chrono>

namespace eventide {

/// How long SIGINT and SIGTERM count as the first signal.
inline constexpr std::chrono::milliseconds kOneWish{500};

/// Whether a signal that comes so long after the first is the same wish to stop, and no second one:
/// timeout(1) signals the program and then its whole group, and a terminal that closes hangs up
/// more than once (the shell and the kernel do).
inline bool repeats_the_first(int number, std::chrono::nanoseconds after_the_first) {
    return number == SIGHUP || after_the_first < kOneWish;
}

}  // namespace eventide
