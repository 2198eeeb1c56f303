// Percentiles of durations from fixed logarithmic buckets: recorded without locks or allocation.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace eventide {

struct LatencySummary {
    std::uint64_t count = 0;
    std::chrono::nanoseconds p50{0}, p90{0}, p99{0}, max{0};
    std::chrono::nanoseconds total{0};
};

/// 16 buckets per doubling, so a percentile is right to 3 %; the maximum is exact.
///
/// Thread: record() from one thread, summary() from any.
class LatencyHistogram {
public:
    void record(std::chrono::nanoseconds latency) noexcept {
        const auto ns = std::uint64_t(std::max<std::int64_t>(latency.count(), 0));
        add(buckets_[bucket_of(ns)], 1);
        add(total_, ns);
        max_.store(std::max(max_.load(std::memory_order_relaxed), ns), std::memory_order_relaxed);
    }

    LatencySummary summary() const {
        std::array<std::uint64_t, kBuckets> counts;
        LatencySummary summary;
        for (std::size_t i = 0; i < kBuckets; ++i)
            summary.count += counts[i] = buckets_[i].load(std::memory_order_relaxed);
        const std::uint64_t max = max_.load(std::memory_order_relaxed);
        const auto percentile = [&](std::uint64_t per_cent) {
            // The smallest value that so many per cent do not exceed.
            const std::uint64_t rank = (summary.count * per_cent + 99) / 100;
            std::uint64_t seen = 0;
            for (std::size_t i = 0; i < kBuckets; ++i)
                if ((seen += counts[i]) >= rank && seen > 0)
                    return std::chrono::nanoseconds{std::min(middle_of(i), max)};
            return std::chrono::nanoseconds{0};
        };
        summary.p50 = percentile(50);
        summary.p90 = percentile(90);
        summary.p99 = percentile(99);
        summary.max = std::chrono::nanoseconds{max};
        summary.total = std::chrono::nanoseconds{total_.load(std::memory_order_relaxed)};
        return summary;
    }

    /// Values below 32 have their own bucket; above, 16 to each power of two.
    static constexpr std::size_t bucket_of(std::uint64_t ns) {
        if (ns < 2 * kPerDoubling) return std::size_t(ns);
        const int shift = int(std::bit_width(ns)) - 1 - kSubBits;
        return std::size_t(shift) * kPerDoubling + std::size_t(ns >> shift);
    }
    static constexpr std::uint64_t middle_of(std::size_t bucket) {
        if (bucket < 2 * kPerDoubling) return bucket;
        const std::size_t shift = bucket / kPerDoubling - 1;
        const std::uint64_t low = std::uint64_t(bucket - shift * kPerDoubling) << shift;
        return low + (std::uint64_t{1} << shift) / 2;
    }

private:
    static constexpr int kSubBits = 4;
    static constexpr std::size_t kPerDoubling = 1U << kSubBits;
    static constexpr std::size_t kBuckets = (63 - kSubBits + 1) * kPerDoubling + kPerDoubling;

    // One thread writes, so no read-modify-write is needed.
    static void add(std::atomic<std::uint64_t>& counter, std::uint64_t n) noexcept {
        counter.store(counter.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);
    }
    std::array<std::atomic<std::uint64_t>, kBuckets> buckets_{};
    std::atomic<std::uint64_t> total_{0}, max_{0};
};

}  // namespace eventide
