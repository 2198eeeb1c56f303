// The oneTBB-backed ParallelFor.
#include "pipeline/parallel_tbb.h"
#include "src/core/error.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <fstream>
#include <vector>

namespace eventide {
namespace {

TEST(ParallelFor, CallsEachIndexOnceForAnyNumberOfThreads) {
    for (const int threads : {0, 1, 2, 5}) {
        const ParallelFor parallel = parallel_for_with(threads);
        for (const int n : {0, 1, 2, 1000}) {
            std::vector<std::atomic<int>> calls(std::size_t(n) + 1);
            parallel(n, [&](int i) { ++calls[std::size_t(i)]; });
            for (int i = 0; i < n; ++i) EXPECT_EQ(calls[std::size_t(i)], 1);
            EXPECT_EQ(calls[std::size_t(n)], 0);
        }
    }
}

TEST(ParallelFor, OneThreadIsTheCallersAndInOrder) {
    std::vector<int> order;
    parallel_for_with(1)(4, [&](int i) { order.push_back(i); });
    EXPECT_EQ(order, (std::vector{0, 1, 2, 3}));
}

/// Of this process.
std::size_t resident_bytes() {
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages >> pages;
    return pages * std::size_t(::sysconf(_SC_PAGESIZE));
}

TEST(ParallelFor, ManyOneAfterTheOtherTakeTheMemoryOfOne) {
    const auto make = [](int count) {
        for (int i = 0; i < count; ++i) parallel_for_with(2)(8, [](int) {});
    };
    make(100);
    const std::size_t before = resident_bytes();
    make(2000);
    EXPECT_LT(resident_bytes(), before + (std::size_t{4} << 20));
}

TEST(ParallelFor, TakesUpNothingOfOneBeforeThatHadAnotherNumberOfThreads) {
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "has threads of its own under the thread sanitizer";
#endif
    for (const int threads : {2, 3, 2, 4, 3}) {
        std::atomic<int> most{0};
        parallel_for_with(threads)(8, [&](int) { most = tbb::this_task_arena::max_concurrency(); });
        EXPECT_EQ(most, std::min(threads, usable_threads())) << threads;
    }
}

TEST(ParallelFor, RefusesANegativeNumber) {
    EXPECT_THROW(parallel_for_with(-1), Error);
}

}  // namespace
}  // namespace eventide
