// Once warm, the library allocates nothing: neither for events nor for frames.
#include "tests/library/library_test.h"
#include "tests/support/allocation_counter.h"

#include <array>

namespace eventide::test {
namespace {

class Memory : public LibraryTest {};

/// A dot that runs round the sensor: every millisecond is as busy as every other.
void fill(std::span<Event> events, int millisecond) {
    for (std::size_t i = 0; i < events.size(); ++i)
        events[i] = {from_us(1000 * millisecond + std::int64_t(i)),
                     std::uint16_t((millisecond + int(i)) % 64), std::uint16_t(millisecond % 48),
                     i % 2 == 0 ? Polarity::on : Polarity::off};
}

TEST_F(Memory, IsTakenOnceAndThenNoMore) {
    if (!can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    for (const char* const window : {"7ms", "auto", "300ev"}) {
        ReconstructorOptions options = repeatable(window, 1);
        options.hot_pixels = "learn";
        Reconstructor reconstructor = this->reconstructor(options);
        std::array<Event, 100> events;
        Frame frame;
        int frames = 0;
        const auto run = [&](int from, int to) {
            for (int ms = from; ms < to; ++ms) {
                fill(events, ms);
                reconstructor.push(events);
                while (reconstructor.next(frame)) ++frames;
                if (reconstructor.ready(frame.t)) reconstructor.render(frame.t, frame);
            }
        };
        run(0, 300);
        AllocationCount count;
        run(300, 900);
        EXPECT_EQ(count.stop(), 0) << window;
        EXPECT_GT(frames, 80);
    }
}

TEST_F(Memory, IsNotTakenAnewWhereFramesOfTwoSizesTakeTurns) {
    if (!can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    Reconstructor reconstructor = this->reconstructor(repeatable("7ms", 0));
    std::array<Event, 100> events;
    Frame frame, large;
    const auto run = [&](int from, int to) {
        for (int ms = from; ms < to; ++ms) {
            fill(events, ms);
            reconstructor.push(events);
            while (reconstructor.next(frame)) reconstructor.render(frame.t, {96, 72}, large);
        }
    };
    run(0, 300);
    AllocationCount count;
    run(300, 600);
    EXPECT_EQ(count.stop(), 0);
}

TEST_F(Memory, IsSeenToBeTakenAtTheBeginning) {
    if (!can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    AllocationCount count;
    reconstructor(repeatable("7ms", 1));
    EXPECT_GT(count.stop(), 0);
}

}  // namespace
}  // namespace eventide::test
