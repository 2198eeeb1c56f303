// A slicer that was reset: nothing is left of the stream before.
#include "tests/binning/event_windows.h"

#include <gtest/gtest.h>

#include <random>

namespace eventide {
namespace {

using namespace std::chrono_literals;

TEST(Slicer, ResetIsAsConstructed) {
    std::mt19937 rng{5};
    const auto events = eventful_stream(rng);
    for (const SlicerSettings& settings :
         {by_duration(1000), by_count(50, 5000), by_reference(5000), by_content(.02, 5000)}) {
        Slicer slicer(settings, 240, 180);
        for (std::size_t i = 0; i < events.size(); i += 100)  // images of what comes then, too
            slicer.push_reference(events[i].t + SensorDuration{321});
        slicer.push({events.data(), events.size() / 2});
        slicer.mark_gap();
        slicer.reset();
        slicer.push(events);
        std::vector<Kept> event_windows;
        take(slicer, event_windows);
        slicer.finish();
        take(slicer, event_windows);
        EXPECT_EQ(event_windows, event_windows_of(settings, events));
    }
}

TEST(Slicer, AResetForgetsAlsoWhatWasHeardAndThatTheStreamStoodStill) {
    const std::vector<Event> before{at(5'000'000)}, events{at(1), at(3'000'000)};
    const SlicerSettings settings = by_duration(1000);
    Slicer slicer(settings, 240, 180);
    slicer.hear(before);
    slicer.push(before);
    slicer.advance(from_us(9'000'000));
    slicer.look_behind(from_us(5'000'000), HostTime{1s});
    slicer.reset();
    EXPECT_FALSE(slicer.begins_anew(from_us(1)));
    std::vector<Kept> event_windows;
    slicer.push(events);
    slicer.finish();
    take(slicer, event_windows);
    EXPECT_EQ(event_windows, event_windows_of(settings, events));

    slicer.reset();
    slicer.push(before);
    slicer.advance(from_us(9'000'000));
    slicer.look_behind(from_us(5'000'000), HostTime{60s});
    slicer.push(std::vector{at(5'000'001)});
    EXPECT_EQ(slicer.counters().time_resets, 0U) << "behind for no second yet";
}

TEST(Slicer, AfterAResetItsBeginAndEndHoldForTheStreamThatComes) {
    SlicerSettings settings = by_duration(1000);
    settings.begin = from_us(2000);
    settings.duration = SensorDuration{3000};
    const std::vector<Event> events{at(1500), at(2500), at(4200), at(9000)};
    const auto expected = event_windows_of(settings, events);
    ASSERT_EQ(expected.back().end_us, 5000);
    Slicer slicer(settings, 240, 180);
    slicer.push(std::vector{at(3000), at(5000), at(100)});  // the clock began anew
    slicer.look_behind(from_us(-9'000'000), HostTime{1s});
    slicer.look_behind(from_us(-9'000'000), HostTime{9s});  // and is about to do so again
    for (int turn = 0; turn < 2; ++turn) {  // the second after one that was past its end
        slicer.reset();
        slicer.push(events);
        EXPECT_TRUE(slicer.is_past_end());
        EXPECT_FALSE(slicer.began_anew());
        std::vector<Kept> event_windows;
        take(slicer, event_windows);
        slicer.finish();
        take(slicer, event_windows);
        EXPECT_EQ(event_windows, expected);
    }
}
}  // namespace
}  // namespace eventide
