// What this process holds, and that opening and closing leaves nothing of it behind.
#pragma once

#include <gtest/gtest.h>

#include <malloc.h>

#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <thread>

namespace eventide::test {

struct Holdings {
    std::size_t files = 0, threads = 0, bytes = 0;  ///< descriptors; threads; of malloc
};

inline Holdings holdings() {
    const auto count = [](const char* folder) {
        return std::size_t(std::distance(std::filesystem::directory_iterator{folder},
                                         std::filesystem::directory_iterator{}));
    };
    return {count("/proc/self/fd"), count("/proc/self/task"), mallinfo2().uordblks};
}

/// The same, looked at until there are no more files and threads than so many: the test bus closes
/// some of its own, and the kernel strikes an ended thread off, a little after it was asked. What
/// is still too much after ten seconds has leaked.
inline Holdings holdings_down_to(const Holdings& wanted) {
    using Clock = std::chrono::steady_clock;
    const auto deadline = Clock::now() + std::chrono::seconds{10};
    Holdings held = holdings();
    while ((held.files > wanted.files || held.threads > wanted.threads) &&
           Clock::now() < deadline) {
        std::this_thread::yield();
        held = holdings();
    }
    return held;
}

/// Runs `once`, which opens, uses and closes something: EVENTIDE_OPENINGS times (scripts/faults.sh:
/// 1,000), 20 unless told. The first tenth fills what is kept on purpose; the rest may leave no
/// file, no thread, and no more memory than 1 KiB for each time, or a megabyte.
inline void expect_nothing_left(const std::function<void()>& once) {
    const char* const asked = std::getenv("EVENTIDE_OPENINGS");
    const int times = asked == nullptr ? 20 : std::atoi(asked);
    ASSERT_GE(times, 20);
    Holdings settled;
    for (int time = 0; time < times; ++time) {
        if (time == times / 10) settled = holdings();
        once();
    }
    const Holdings left = holdings_down_to(settled);
    EXPECT_LE(left.files, settled.files);
    EXPECT_LE(left.threads, settled.threads);
    const double most = 1024.0 * (times < 1024 ? 1024 : times);
    EXPECT_LT(double(left.bytes) - double(settled.bytes), most) << times << " times";
}

}  // namespace eventide::test
