// Once warm the pipeline allocates nothing.
#include "tests/pipeline/toy_pipeline.h"
#include "tests/support/allocation_counter.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

namespace eventide {
namespace {

using namespace test;

TEST(AllocationCounter, SeesAnAllocation) {
    if (!can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    AllocationCount count;
    const auto with_new = std::make_unique<int>(1);
    std::vector<int, CacheLineAllocator<int>> aligned(100);
    std::jthread other{[] { free(malloc(10)); }};
    other.join();
    EXPECT_GE(count.stop(), 3);
}

TEST(Pipeline, AllocatesNothingOnceWarm) {
    if (!can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    for (const bool threaded : {true, false}) {
        constexpr std::size_t kFrames = 4000;
        std::vector<std::vector<std::byte>> packets(kFrames);
        for (std::size_t i = 0; i < kFrames; ++i)
            for (int n = 0; n < 30; ++n)
                append_record(packets[i], ToyKind::event, std::int64_t(1000 * i + 1) + 30 * n,
                              n % kToyWidth, n % kToyHeight, n % 2 == 0);
        PipelineSettings settings = quick_settings();
        settings.lookahead = 2;
        settings.event_preview = true;
        PipelineUnderTest line(packets, settings);
        line.sink.keeps = false;
        std::int64_t allocations = -1;
        line.sink.before_write = [&](std::uint64_t frame) {
            if (frame == 1000) start_counting_allocations();
            if (frame == 7000) allocations = stop_counting_allocations();
        };
        threaded ? line.run() : line.run_sequential();
        EXPECT_EQ(allocations, 0) << (threaded ? "threaded" : "sequential");
    }
}

}  // namespace
}  // namespace eventide
