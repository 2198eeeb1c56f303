// The oneTBB-backed ParallelFor.
#include "pipeline/parallel_tbb.h"
#include "src/core/error.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
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

TEST(ParallelFor, RefusesANegativeNumber) {
    EXPECT_THROW(parallel_for_with(-1), Error);
}

}  // namespace
}  // namespace eventide
