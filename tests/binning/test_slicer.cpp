// The slicer: the same frames however the stream is split, and the three ways to cut.
#include "src/core/error.h"
#include "tests/binning/event_windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace eventide {
namespace {

using namespace std::chrono_literals;

TEST(Slicer, CutsTheSameFramesHoweverTheStreamIsSplit) {
    SlicerSettings ended = by_duration(1000);
    ended.begin = from_us(1'700'000'000'001'234);
    ended.end = from_us(1'700'000'000'020'000);
    SlicerSettings small = by_duration(1000);
    small.max_events = 7;
    const std::vector<std::pair<std::string, SlicerSettings>> rules{
        {"duration", by_duration(1000)},
        {"count", by_count(50, 5000)},
        {"reference", by_reference(4000)},
        {"content", by_content(.02, 5000)},
        {"from to", ended},
        {"few events", small}};
    for (const auto& [name, settings] : rules)
        for (unsigned seed = 0; seed < 20; ++seed) {
            SCOPED_TRACE(name + " seed " + std::to_string(seed));
            std::mt19937 rng{seed};
            const auto events = eventful_stream(rng);
            const std::vector<Kept> whole = event_windows_of(settings, events);
            Slicer slicer(settings, 240, 180);
            std::vector<Kept> split;
            for (std::size_t i = 0; i < events.size();) {
                const auto n =
                    std::min<std::size_t>(rng() % (seed % 2 ? 5 : 500), events.size() - i);
                slicer.push({events.data() + i, n});
                if (rng() % 3 != 0) take(slicer, split);
                i += n;
            }
            slicer.finish();
            take(slicer, split);
            ASSERT_EQ(split, whole);
        }
}

TEST(Slicer, PutsEveryEventInOneFrameAndLeavesNoHoleBetweenFrames) {
    for (const SlicerSettings& settings :
         {by_duration(777), by_count(33), by_reference(5000), by_content(.05, 5000)}) {
        std::mt19937 rng{11};
        const auto events = eventful_stream(rng);
        std::vector<Event> seen;
        std::int64_t end = 1'699'999'999'999'999 + to_us(events.front().t) - 1'700'000'000'000'000;
        for (const Kept& event_window : event_windows_of(settings, events)) {
            if (!event_window.reset) {
                ASSERT_EQ(event_window.begin_us, end);
            }
            end = event_window.end_us;
            ASSERT_LT(event_window.begin_us, event_window.end_us);
            for (const Event& event : event_window.events) {
                ASSERT_GT(to_us(event.t), event_window.begin_us);
                ASSERT_LE(to_us(event.t), event_window.end_us);
                seen.push_back(event);
            }
        }
        EXPECT_EQ(seen, events);
    }
}

TEST(Slicer, CutsConstantWidthsFromJustBeforeTheFirstEvent) {
    EXPECT_EQ(edges_of(event_windows_of(by_duration(10), {at(101), at(110), at(111), at(125)})),
              (Edges{{100, 110}, {110, 120}, {120, 125}}));
}

TEST(Slicer, CutsAtTheNthEventAndKeepsItsMicrosecondTogether) {
    const auto event_windows =
        event_windows_of(by_count(2), {at(1), at(5), at(5), at(5), at(6), at(9), at(12)});
    EXPECT_EQ(edges_of(event_windows), (Edges{{0, 5}, {5, 9}, {9, 12}}));
    EXPECT_EQ(event_windows[0].events.size(), 4U);
}

TEST(Slicer, EndsAFrameOfFewEventsAtTheMaximumWidth) {
    EXPECT_EQ(edges_of(event_windows_of(by_count(100, 10), {at(1), at(5), at(25)})),
              (Edges{{0, 10}, {10, 20}, {20, 25}}));
}

TEST(Slicer, CountsEventsPerPixel) {
    SlicerSettings settings = by_count(0);
    settings.events_per_pixel = 0.5;
    Slicer slicer(settings, 4, 3);
    std::vector<Event> events;
    for (int t = 1; t <= 13; ++t) events.push_back(at(t));
    slicer.push(events);
    std::vector<Kept> event_windows;
    take(slicer, event_windows);
    EXPECT_EQ(edges_of(event_windows), (Edges{{0, 6}, {6, 12}}));
    settings.events_per_pixel = 0.01;
    EXPECT_EQ(events_per_window(settings, 4, 3), 1U) << "none would be no window";
}

TEST(Slicer, CutsAtReferenceImagesThatComeEarlyOrLate) {
    const Edges expected{{0, 40}, {40, 80}, {80, 120}, {120, 130}};
    std::vector<Event> events;
    for (int t = 1; t <= 130; ++t) events.push_back(at(t));
    EXPECT_EQ(edges_of(event_windows_of(by_reference(1000), events, {40, 80, 120})), expected);
    for (const std::ptrdiff_t delay : {0, 1, 5, 30, 60}) {
        SCOPED_TRACE(delay);
        Slicer slicer(by_reference(1000), 240, 180);
        std::vector<Kept> event_windows;
        for (const Event& event : events) {
            slicer.push({&event, 1});
            const auto t = to_us(event.t) - delay;
            if (t > 0 && t % 40 == 0) slicer.push_reference(from_us(t));
            take(slicer, event_windows);
        }
        for (const std::int64_t t : {40, 80, 120})
            if (t + delay > 130) slicer.push_reference(from_us(t));
        slicer.finish();
        take(slicer, event_windows);
        EXPECT_EQ(edges_of(event_windows), expected);
        EXPECT_EQ(slicer.counters().late_references, 0U);
    }
}

TEST(Slicer, CutsAtAnImageOnlyWhenTheStreamHasPassedIt) {
    Slicer slicer(by_reference(1000), 240, 180);
    slicer.push_reference(from_us(40));
    const std::vector<Event> first{at(1), at(40)}, second{at(40)}, third{at(41)};
    std::vector<Kept> event_windows;
    for (const auto& events : {first, second}) {
        slicer.push(events);
        take(slicer, event_windows);
        EXPECT_TRUE(event_windows.empty()) << "more events of that microsecond may come";
    }
    slicer.push(third);
    take(slicer, event_windows);
    ASSERT_EQ(event_windows.size(), 1U);
    EXPECT_EQ(event_windows[0].events.size(), 3U);
}

TEST(Slicer, WaitsForALateImageAsLongAsItSaysThenCutsAtTheMaximumWidth) {
    Slicer slicer(by_reference(100, 50), 240, 180);
    std::vector<Kept> event_windows;
    const std::vector<Event> first{at(1)};
    slicer.push(first);
    slicer.advance(from_us(150));
    take(slicer, event_windows);
    EXPECT_TRUE(event_windows.empty());
    slicer.advance(from_us(151));
    take(slicer, event_windows);
    EXPECT_EQ(edges_of(event_windows), (Edges{{0, 100}}));
    slicer.push_reference(from_us(60));
    EXPECT_EQ(slicer.counters().late_references, 1U);
    slicer.push_reference(from_us(0));
    EXPECT_EQ(slicer.counters().late_references, 1U) << "of before the first window";
}

}  // namespace
}  // namespace eventide
