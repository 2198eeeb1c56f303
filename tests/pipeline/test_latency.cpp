// Percentiles from buckets against percentiles from sorting.
#include "pipeline/pace/latency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace eventide {
namespace {

using std::chrono::nanoseconds;

TEST(Latency, BucketsFollowEachOtherAndHoldTheirMiddle) {
    for (std::uint64_t ns = 1; ns < (std::uint64_t{1} << 62); ns += 1 + ns / 7) {
        const auto bucket = LatencyHistogram::bucket_of(ns);
        const auto before = LatencyHistogram::bucket_of(ns - 1);
        EXPECT_TRUE(bucket == before || bucket == before + 1) << ns;
        const auto middle = LatencyHistogram::middle_of(bucket);
        EXPECT_EQ(LatencyHistogram::bucket_of(middle), bucket) << ns;
        EXPECT_LE(std::abs(double(middle) - double(ns)), double(ns) / 16 + 1) << ns;
    }
}

TEST(Latency, AgreesWithSorting) {
    std::mt19937_64 rng{1};
    std::lognormal_distribution<double> latency{15, 2};  // about 3 ms, some of seconds
    LatencyHistogram histogram;
    std::vector<double> sorted;
    for (int i = 0; i < 20'000; ++i) {
        const auto ns = std::int64_t(latency(rng));
        histogram.record(nanoseconds{ns});
        sorted.push_back(double(ns));
    }
    std::sort(sorted.begin(), sorted.end());
    const LatencySummary summary = histogram.summary();
    const auto near = [&](nanoseconds found, double share) {
        const double expected = sorted[std::size_t(share * double(sorted.size())) - 1];
        EXPECT_NEAR(double(found.count()), expected, expected / 16) << share;
    };
    EXPECT_EQ(summary.count, sorted.size());
    near(summary.p50, 0.5);
    near(summary.p90, 0.9);
    near(summary.p99, 0.99);
    EXPECT_EQ(double(summary.max.count()), sorted.back());
}

TEST(Latency, OfNothingIsNothing) {
    const LatencySummary summary = LatencyHistogram{}.summary();
    EXPECT_EQ(summary.count, 0U);
    EXPECT_EQ(summary.p99.count(), 0);
}

TEST(Latency, OfOneSampleIsThatSample) {
    LatencyHistogram histogram;
    histogram.record(nanoseconds{20});
    for (const auto p : {histogram.summary().p50, histogram.summary().p99, histogram.summary().max})
        EXPECT_EQ(p.count(), 20);
}

TEST(Latency, TakesAnyDuration) {
    LatencyHistogram histogram;
    histogram.record(nanoseconds{-5});
    histogram.record(nanoseconds::max());
    EXPECT_EQ(histogram.summary().count, 2U);
    EXPECT_EQ(histogram.summary().max, nanoseconds::max());
}

}  // namespace
}  // namespace eventide
