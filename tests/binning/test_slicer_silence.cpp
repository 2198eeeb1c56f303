// The slicer where nothing comes, where data are missing, and at its limits.
#include "src/core/error.h"
#include "tests/binning/event_windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>
#include <span>

namespace eventide {
namespace {

using namespace std::chrono_literals;

TEST(Slicer, ClosesFramesInSilenceByTheClock) {
    Slicer slicer(by_duration(10), 240, 180);
    std::vector<Kept> event_windows;
    const std::vector<Event> one{at(1)};
    slicer.push(one);
    slicer.advance(from_us(10));
    take(slicer, event_windows);
    EXPECT_TRUE(event_windows.empty()) << "more events at 10 may come";
    for (int t = 11; t <= 35; ++t) {
        slicer.advance(from_us(t));
        take(slicer, event_windows);
    }
    EXPECT_EQ(edges_of(event_windows), (Edges{{0, 10}, {10, 20}, {20, 30}}));
    slicer.advance(from_us(20));  // a clock that goes back a little changes nothing
    slicer.finish();
    take(slicer, event_windows);
    EXPECT_EQ(event_windows.back().end_us, 35);
}

TEST(Slicer, BeginsWithTheClockWhereNoEventHasComeYet) {
    Slicer slicer(by_duration(10), 240, 180);
    EXPECT_FALSE(slicer.has_begun());
    std::vector<Kept> event_windows;
    slicer.advance(from_us(101));
    slicer.advance(from_us(111));
    take(slicer, event_windows);
    EXPECT_EQ(edges_of(event_windows), (Edges{{100, 110}}));
}

TEST(Slicer, AJumpOfHoursGivesAHandfulOfFrames) {
    constexpr std::int64_t kHours = 5 * 3'600'000'000LL;
    for (const SlicerSettings& settings :
         {by_duration(1000), by_count(10, 1000), by_reference(1000)}) {
        const auto event_windows =
            event_windows_of(settings, {at(1), at(kHours + 1), at(kHours + 2)});
        ASSERT_EQ(event_windows.size(), 1U + 16U + 1U + 2U + 1U);
        EXPECT_EQ(event_windows[0].events.size(), 1U);
        EXPECT_EQ(event_windows[16].end_us - event_windows[16].begin_us, 1000);
        EXPECT_EQ(event_windows[17].end_us % 1000, 0)
            << "later edges stay where they would have been";
        EXPECT_EQ(event_windows[17].end_us, event_windows[18].begin_us);
        EXPECT_LE(kHours - event_windows[20].begin_us, 1000);
        EXPECT_EQ(event_windows[20].events.size(), 2U);
    }
}

/// Frames of an event window read up to two more, so that with lookahead a wide one would show all
/// along what comes after it.
TEST(Slicer, AJumpOfHoursGivesAHandfulOfFramesAlsoAfterTheClockBeganAnew) {
    constexpr std::int64_t kHours = 10'000'000'000;
    const auto event_windows = event_windows_of(
        by_duration(1000), {at(5'000'001), at(5'000'500), at(10), at(900), at(kHours)});
    EXPECT_LT(event_windows.size(), 100U);
    EXPECT_EQ(event_windows.back().end_us, kHours);
}

TEST(Slicer, TheLastWindowsOfALongSilenceComeOneByOne) {
    for (const std::int64_t silence_us : {18'500, 19'500, 20'000, 20'500, 60'500}) {
        const auto event_windows =
            event_windows_of(by_duration(1000), {at(1), at(1 + silence_us), at(2 + silence_us)});
        ASSERT_GT(event_windows.size(), 3U);
        for (std::size_t i = event_windows.size() - 3; i + 1 < event_windows.size(); ++i) {
            EXPECT_TRUE(event_windows[i].events.empty());
            EXPECT_EQ(event_windows[i].end_us - event_windows[i].begin_us, 1000) << silence_us;
        }
    }
    const auto wide = event_windows_of(by_duration(1000), {at(1), at(60'501), at(60'502)});
    EXPECT_EQ(wide[17].begin_us, 17'000);
    EXPECT_EQ(wide[17].end_us, 58'000);
}

/// Of a stream of which a filter leaves the events of x 0, so many at a time.
std::vector<Kept> filtered_windows_of(const SlicerSettings& settings,
                                      const std::vector<Event>& events, std::size_t at_a_time) {
    Slicer slicer(settings, 240, 180);
    std::vector<Kept> event_windows;
    for (std::size_t i = 0; i < events.size(); i += at_a_time) {
        const auto part = std::span{events}.subspan(i, std::min(at_a_time, events.size() - i));
        std::vector<Event> left;
        std::ranges::copy_if(part, std::back_inserter(left),
                             [](const Event& e) { return e.x == 0; });
        slicer.hear(part);
        slicer.push(left);
        slicer.advance(part.back().t);
        take(slicer, event_windows);
    }
    slicer.finish();
    take(slicer, event_windows);
    return event_windows;
}

TEST(Slicer, CutsTheSameWindowsInSilenceHoweverWhatIsLeftOutIsSplit) {
    for (const SlicerSettings& settings : {by_duration(1000), by_count(10, 1000)}) {
        std::mt19937 rng{7};
        std::vector<Event> events;
        std::int64_t t = 1;
        for (int i = 0; i < 400; ++i) {
            // Noise every other window, now and then nothing for a while, and seldom what is kept.
            t += std::int64_t(rng() % 10 == 0 ? rng() % 90'000 : rng() % 2'000);
            events.push_back(at(t, rng() % 60 == 0 ? 0 : 1));
        }
        const auto one_by_one = filtered_windows_of(settings, events, 1);
        EXPECT_GT(one_by_one.size(), 100U);
        EXPECT_TRUE(std::ranges::any_of(one_by_one, [](const Kept& event_window) {
            return event_window.end_us - event_window.begin_us > 1000;
        })) << "silence that nothing breaks is one window still";
        for (const std::size_t at_a_time : {7, 100, 400})
            EXPECT_EQ(filtered_windows_of(settings, events, at_a_time), one_by_one) << at_a_time;
    }
}

TEST(Slicer, EndsALongSilenceAtAReferenceImage) {
    const auto event_windows = event_windows_of(by_reference(10), {at(1), at(10'000)}, {5'005});
    const auto edge =
        std::find_if(event_windows.begin(), event_windows.end(),
                     [](const Kept& event_window) { return event_window.end_us == 5'005; });
    EXPECT_NE(edge, event_windows.end());
    EXPECT_LT(event_windows.size(), 60U);
}

TEST(Slicer, MarksTheEventWindowAfterALoss) {
    Slicer slicer(by_duration(10), 240, 180);
    std::vector<Kept> event_windows;
    const std::vector<Event> before{at(1), at(12)}, after{at(38)};
    slicer.push(before);
    take(slicer, event_windows);
    slicer.mark_gap();
    slicer.push(after);
    take(slicer, event_windows);
    ASSERT_EQ(event_windows.size(), 3U);
    EXPECT_FALSE(event_windows[0].gap);
    EXPECT_TRUE(event_windows[1].gap);
    EXPECT_FALSE(event_windows[2].gap);
}

TEST(Slicer, TimeGoingBackEndsTheStreamAndBeginsANewOne) {
    const auto event_windows =
        event_windows_of(by_duration(10), {at(1001), at(1013), at(5), at(21), at(3)});
    EXPECT_EQ(edges_of(event_windows),
              (Edges{{1000, 1010}, {1010, 1013}, {4, 14}, {14, 21}, {2, 3}}));
    EXPECT_EQ(event_windows[1].reset, false);
    EXPECT_EQ(event_windows[2].reset, true);
    EXPECT_EQ(event_windows[3].reset, false);
    EXPECT_EQ(event_windows[4].reset, true);
}

TEST(Slicer, KeepsToTheAskedSpan) {
    SlicerSettings settings = by_duration(10);
    settings.begin = from_us(100);
    settings.end = from_us(125);
    Slicer slicer(settings, 240, 180);
    const std::vector<Event> events{at(90), at(100), at(101), at(125), at(126), at(400)};
    slicer.push(events);
    EXPECT_TRUE(slicer.is_past_end());
    std::vector<Kept> event_windows;
    take(slicer, event_windows);
    EXPECT_EQ(edges_of(event_windows), (Edges{{100, 110}, {110, 120}, {120, 125}}));
    EXPECT_EQ(event_windows[0].events.size(), 1U);
    EXPECT_EQ(event_windows[2].events.size(), 1U);
    EXPECT_EQ(slicer.counters().before_begin, 2U);
    EXPECT_EQ(slicer.counters().after_end, 2U);
}

TEST(Slicer, EndsAStreamOfUnknownTimesAfterADurationInSilenceToo) {
    SlicerSettings settings = by_duration(100);
    settings.duration = SensorDuration{250};
    Slicer slicer{settings, 240, 180};
    std::vector<Kept> event_windows;
    slicer.push(std::vector{at(1001, 1)});
    slicer.advance(from_us(1200));
    take(slicer, event_windows);
    EXPECT_FALSE(slicer.is_past_end());
    slicer.advance(from_us(5000));
    take(slicer, event_windows);
    EXPECT_TRUE(slicer.is_past_end());
    EXPECT_EQ(edges_of(event_windows), (Edges{{1000, 1100}, {1100, 1200}, {1200, 1250}}));
}

TEST(Slicer, ADurationGoesOnWhereTheClockBeginsAnew) {
    SlicerSettings settings = by_duration(100);
    settings.duration = SensorDuration{250};
    Slicer slicer{settings, 240, 180};
    std::vector<Kept> event_windows;
    for (const auto& [event, advanced] : {std::pair{1001, 1150}, {501, 560}, {31, 50}}) {
        slicer.push(std::vector{at(event)});
        slicer.advance(from_us(advanced));
        take(slicer, event_windows);
        EXPECT_FALSE(slicer.is_past_end());
    }
    slicer.advance(from_us(500));
    take(slicer, event_windows);
    EXPECT_TRUE(slicer.is_past_end());
    EXPECT_EQ(edges_of(event_windows), (Edges{{1000, 1100}, {1100, 1150}, {500, 560}, {30, 70}}))
        << "150, 60 and 40 of 250";
    // Nothing is left of it.
    Slicer ended{settings, 240, 180};
    event_windows.clear();
    ended.push(std::vector{at(1001), at(1250), at(7), at(9)});
    take(ended, event_windows);
    EXPECT_TRUE(ended.is_past_end());
    EXPECT_EQ(edges_of(event_windows), (Edges{{1000, 1100}, {1100, 1200}, {1200, 1250}, {6, 7}}));
}

TEST(Slicer, MovesAnEventThatComesAfterItsFrameWasClosed) {
    Slicer slicer(by_duration(10), 240, 180);
    std::vector<Kept> event_windows;
    const std::vector<Event> first{at(1)}, late{at(7), at(29)};
    slicer.push(first);
    slicer.advance(from_us(25));
    take(slicer, event_windows);
    slicer.push(late);
    slicer.finish();
    take(slicer, event_windows);
    EXPECT_EQ(slicer.counters().late, 1U);
    ASSERT_EQ(event_windows.size(), 3U);
    EXPECT_EQ(event_windows[2].events, (std::vector{at(21), at(29)}));
}

TEST(Slicer, BeginsAnewWhereASourceStaysBehindWhatWasPromised) {
    Slicer slicer(by_duration(1'000'000), 240, 180);
    std::vector<Kept> event_windows;
    std::int64_t host_us = 0;
    const auto give = [&](std::int64_t t_us) {
        const std::vector<Event> one{at(t_us)};
        const HostTime arrived{std::chrono::microseconds{host_us}};
        slicer.look_behind(one.back().t, arrived);
        slicer.push(one, arrived);
        take(slicer, event_windows);
    };
    give(1);
    slicer.advance(from_us(20'000'001));
    take(slicer, event_windows);
    for (const int host_ms : {0, 500, 999}) {
        host_us = 1000 * host_ms;
        give(2 + host_us);
    }
    EXPECT_EQ(slicer.counters().late, 3U) << "it may catch up";
    EXPECT_EQ(slicer.counters().time_resets, 0U);
    host_us = 1'000'000;
    give(host_us);
    EXPECT_EQ(slicer.counters().late, 3U);
    EXPECT_EQ(slicer.counters().time_resets, 1U);
    host_us = 9'000'000;
    give(host_us);
    EXPECT_EQ(slicer.counters().time_resets, 1U);
    EXPECT_EQ(event_windows.back().end_us, 8'999'999);
}

TEST(Slicer, BoundsMemoryByEndingFramesAndLeavingOutWhatNoCameraSends) {
    SlicerSettings settings = by_duration(1000);
    settings.max_events = 4;
    std::vector<Event> events(10, at(1));
    for (int t = 2; t < 12; ++t) events.push_back(at(t));
    Slicer slicer(settings, 240, 180);
    slicer.push(events);
    slicer.finish();
    std::vector<Kept> event_windows;
    take(slicer, event_windows);
    EXPECT_EQ(slicer.counters().too_many, 6U);
    EXPECT_EQ(edges_of(event_windows), (Edges{{0, 1}, {1, 5}, {5, 9}, {9, 11}}));
    for (const Kept& event_window : event_windows) EXPECT_LE(event_window.events.size(), 4U);
}

TEST(Slicer, EndsWithWhatWasHeardLastThoughAFilterLeftItOut) {
    Slicer slicer(by_duration(1000), 240, 180);
    slicer.hear(std::vector{at(1), at(4500)});
    slicer.push(std::vector{at(1)});
    slicer.finish();
    std::vector<Kept> event_windows;
    take(slicer, event_windows);
    ASSERT_FALSE(event_windows.empty());
    EXPECT_EQ(event_windows.back().end_us, 4500);
}

TEST(Slicer, AWindowArrivedWithItsLastEvents) {
    Slicer slicer(by_duration(1000), 240, 180);
    slicer.push(std::vector{at(1), at(1500)}, HostTime{1s});
    slicer.push({}, HostTime{9s});  // of a packet whose events were all left out
    EventWindow event_window;
    ASSERT_TRUE(slicer.next(event_window));
    EXPECT_EQ(event_window.arrived, HostTime{1s});
}

TEST(Slicer, AnEmptyStreamHasNoFrames) {
    for (const SlicerSettings& settings : {by_duration(10), by_count(5), by_reference(10)})
        EXPECT_TRUE(event_windows_of(settings, {}).empty());
}

TEST(Slicer, RefusesSettingsOutOfRange) {
    EXPECT_THROW(Slicer(by_duration(0), 2, 2), Error);
    EXPECT_THROW(Slicer(by_count(0), 2, 2), Error);
    EXPECT_THROW(Slicer(by_count(5, 0), 2, 2), Error);
    EXPECT_THROW(Slicer(by_duration(10), 0, 2), Error);
}

}  // namespace
}  // namespace eventide
