// Windows that the encoder has no time for become one.
#include "pipeline/pace/encoder_gate.h"

#include "pipeline/pace/latency_keeper.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace eventide {
namespace {

using namespace std::chrono_literals;

EventWindow event_window_of(std::int64_t begin_us, std::int64_t end_us,
                            const std::vector<Event>& events) {
    EventWindow event_window;
    event_window.window = {from_us(begin_us), from_us(end_us)};
    event_window.events = events;
    event_window.arrived = HostTime{std::chrono::microseconds{end_us}};
    return event_window;
}

TEST(EncoderGate, NeverHasMoreWindowsWithTheEncoderThanThereAreBuffers) {
    // Nothing is known yet, so no window is thought to be late; but a fourth would wait.
    LatencyKeeper keeper{200ms};
    std::size_t lent = 0;
    EncoderGate gate{
        keeper, {.most = 3}, [&] { return lent; }, [&](const EventWindow&) { ++lent; }};
    for (int k = 0; k < 6; ++k) gate.take(event_window_of(10'000 * k, 10'000 * (k + 1), {}));
    EXPECT_EQ(lent, 3U);
    EXPECT_EQ(gate.merged(), 2U) << "the fourth waits, and two more with it";
    lent = 2;
    gate.look_again();
    EXPECT_EQ(lent, 3U);
}

TEST(EncoderGate, WindowsThatWaitGoOnBeforeAndWithTheNext) {
    LatencyKeeper keeper{200ms};
    std::size_t lent = 1;
    std::vector<Window> given;
    EncoderGate gate{
        keeper,
        {.most = 1},
        [&] { return lent; },
        [&](const EventWindow& event_window) { given.push_back(event_window.window); }};
    gate.take(event_window_of(0, 10, {}));
    EXPECT_TRUE(given.empty());
    lent = 0;
    gate.take(event_window_of(10, 20, {}));
    EXPECT_EQ(given, (std::vector<Window>{{from_us(0), from_us(20)}}));
}

TEST(EncoderGate, NothingIsMergedOverAGapWhereStateBeginsAnew) {
    for (const bool anew : {false, true}) {
        LatencyKeeper keeper{200ms};
        std::vector<Window> given;
        EncoderGate gate{
            keeper,
            {.most = 1, .new_state_after_gaps = anew},
            [] { return std::size_t{1}; },
            [&](const EventWindow& event_window) { given.push_back(event_window.window); }};
        EventWindow after_gap = event_window_of(10, 20, {});
        after_gap.gap_before = true;
        gate.take(event_window_of(0, 10, {}));
        gate.take(after_gap);
        EXPECT_EQ(given.size(), anew ? 1U : 0U) << "goes on, whatever the encoder has to do";
        gate.flush();
        EXPECT_EQ(given.back(), (Window{from_us(anew ? 10 : 0), from_us(20)}));
    }
}

TEST(EncoderGate, AWindowThatWaitsKnowsNoImageOfTheClockThatBeginsAnew) {
    LatencyKeeper keeper{200ms};
    std::vector<std::uint64_t> images;
    EncoderGate gate{keeper,
                     {.most = 1},
                     [] { return std::size_t{1}; },
                     [&](const CutWindow& event_window) { images.push_back(event_window.images); }};
    CutWindow anew{event_window_of(0, 10, {}), 5};
    anew.reset_before = true;
    gate.take({event_window_of(500, 510, {}), 1});
    gate.take({event_window_of(510, 520, {}), 2});
    gate.take(anew);
    EXPECT_EQ(images, (std::vector<std::uint64_t>{2})) << "as the last of those that became one";
    gate.flush();
    EXPECT_EQ(images.back(), 5U);
}

TEST(WindowMerger, IsAllItsWindowsAndNothingElse) {
    const std::vector<Event> first{{from_us(3), 1, 2, Polarity::on}},
        second{{from_us(15), 3, 4, Polarity::off}};
    WindowMerger merger{2};
    EXPECT_TRUE(merger.empty());
    EventWindow broken = event_window_of(10, 20, second);
    broken.gap_before = true;
    merger.add(event_window_of(0, 10, first));
    EXPECT_TRUE(merger.takes(broken, false));
    EXPECT_FALSE(merger.takes(broken, true)) << "state begins anew there";
    EventWindow reset = event_window_of(0, 20, second);
    reset.reset_before = true;
    EXPECT_FALSE(merger.takes(reset, false));
    merger.add(broken);
    EXPECT_FALSE(merger.takes(event_window_of(20, 30, first), false)) << "enough events";
    const EventWindow merged = merger.take();
    EXPECT_EQ(merged.window, (Window{from_us(0), from_us(20)}));
    EXPECT_EQ(merged.events.size(), 2U);
    EXPECT_EQ(merged.events[1].x, 3);
    EXPECT_TRUE(merged.gap_before);
    EXPECT_EQ(merged.arrived, broken.arrived) << "of the newest packet in it";
    EXPECT_TRUE(merger.empty());
    merger.add(event_window_of(20, 30, first));
    EXPECT_EQ(merger.take().events.size(), 1U);
    merger.add(broken);
    merger.add(event_window_of(20, 30, {}));
    EXPECT_TRUE(merger.take().gap_before) << "before the first of them";
}

}  // namespace
}  // namespace eventide
