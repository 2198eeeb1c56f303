// The slicer: the same frames however the stream is split, the three rules, silence, gaps, resets.
#include "src/binning/slicer.h"
#include "src/core/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <random>
#include <string>
#include <vector>

namespace eventide {
namespace {

using namespace std::chrono_literals;

/// A slice that outlives the slicer's next call.
struct Kept {
    std::int64_t begin_us, end_us;
    std::vector<Event> events;
    bool gap, reset;
    friend bool operator==(const Kept&, const Kept&) = default;
};

void PrintTo(const Kept& slice, std::ostream* out) {
    *out << '(' << slice.begin_us << ", " << slice.end_us << "] " << slice.events.size()
         << " events" << (slice.gap ? " gap" : "") << (slice.reset ? " reset" : "");
}

Event at(std::int64_t t_us, int x = 0) {
    return {from_us(t_us), std::uint16_t(x), 0, Polarity::on};
}

void take(Slicer& slicer, std::vector<Kept>& into) {
    for (Slice slice; slicer.next(slice);)
        into.push_back({to_us(slice.window.begin),
                        to_us(slice.window.end),
                        {slice.events.begin(), slice.events.end()},
                        slice.gap_before,
                        slice.reset_before});
}

std::vector<Kept> slices_of(const SlicerSettings& settings, const std::vector<Event>& events,
                            const std::vector<std::int64_t>& images = {}) {
    Slicer slicer(settings, 240, 180);
    std::vector<Kept> slices;
    for (const auto t : images) slicer.push_reference(from_us(t));
    slicer.push(events);
    take(slicer, slices);
    slicer.finish();
    take(slicer, slices);
    return slices;
}

using Edges = std::vector<std::pair<std::int64_t, std::int64_t>>;

Edges edges_of(const std::vector<Kept>& slices) {
    Edges edges;
    for (const Kept& slice : slices) edges.emplace_back(slice.begin_us, slice.end_us);
    return edges;
}

SlicerSettings by_duration(std::int64_t us) {
    SlicerSettings settings;
    settings.width = SensorDuration{us};
    return settings;
}

SlicerSettings by_count(std::uint64_t events, std::int64_t max_us = 1'000'000) {
    SlicerSettings settings;
    settings.rule = SliceRule::count;
    settings.events = events;
    settings.max_width = SensorDuration{max_us};
    return settings;
}

SlicerSettings by_reference(std::int64_t max_us, std::int64_t wait_us = 1000) {
    SlicerSettings settings;
    settings.rule = SliceRule::reference;
    settings.max_width = SensorDuration{max_us};
    settings.reference_wait = SensorDuration{wait_us};
    return settings;
}

/// Bursts, equal timestamps, pauses of many frames, and a clock reset.
std::vector<Event> eventful_stream(std::mt19937& rng) {
    std::vector<Event> events;
    std::int64_t t = 1'700'000'000'000'000;
    for (int i = 0; i < 4000; ++i) {
        if (i == 3000) t = 5000;
        const auto dice = rng() % 1000;
        t += dice < 300 ? 0 : dice < 990 ? rng() % 20 : dice < 997 ? rng() % 3000 : rng() % 100'000;
        events.push_back(at(t, i % 240));
    }
    return events;
}

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
        {"from to", ended},
        {"few events", small}};
    for (const auto& [name, settings] : rules)
        for (unsigned seed = 0; seed < 20; ++seed) {
            SCOPED_TRACE(name + " seed " + std::to_string(seed));
            std::mt19937 rng{seed};
            const auto events = eventful_stream(rng);
            const std::vector<Kept> whole = slices_of(settings, events);
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
    for (const SlicerSettings& settings : {by_duration(777), by_count(33), by_reference(5000)}) {
        std::mt19937 rng{11};
        const auto events = eventful_stream(rng);
        std::vector<Event> seen;
        std::int64_t end = 1'699'999'999'999'999 + to_us(events.front().t) - 1'700'000'000'000'000;
        for (const Kept& slice : slices_of(settings, events)) {
            if (!slice.reset) {
                ASSERT_EQ(slice.begin_us, end);
            }
            end = slice.end_us;
            ASSERT_LT(slice.begin_us, slice.end_us);
            for (const Event& event : slice.events) {
                ASSERT_GT(to_us(event.t), slice.begin_us);
                ASSERT_LE(to_us(event.t), slice.end_us);
                seen.push_back(event);
            }
        }
        EXPECT_EQ(seen, events);
    }
}

TEST(Slicer, CutsConstantWidthsFromJustBeforeTheFirstEvent) {
    EXPECT_EQ(edges_of(slices_of(by_duration(10), {at(101), at(110), at(111), at(125)})),
              (Edges{{100, 110}, {110, 120}, {120, 125}}));
}

TEST(Slicer, CutsAtTheNthEventAndKeepsItsMicrosecondTogether) {
    const auto slices = slices_of(by_count(2), {at(1), at(5), at(5), at(5), at(6), at(9), at(12)});
    EXPECT_EQ(edges_of(slices), (Edges{{0, 5}, {5, 9}, {9, 12}}));
    EXPECT_EQ(slices[0].events.size(), 4U);
}

TEST(Slicer, EndsAFrameOfFewEventsAtTheMaximumWidth) {
    EXPECT_EQ(edges_of(slices_of(by_count(100, 10), {at(1), at(5), at(25)})),
              (Edges{{0, 10}, {10, 20}, {20, 25}}));
}

TEST(Slicer, CountsEventsPerPixel) {
    SlicerSettings settings = by_count(0);
    settings.events_per_pixel = 0.5;
    Slicer slicer(settings, 4, 3);
    std::vector<Event> events;
    for (int t = 1; t <= 13; ++t) events.push_back(at(t));
    slicer.push(events);
    std::vector<Kept> slices;
    take(slicer, slices);
    EXPECT_EQ(edges_of(slices), (Edges{{0, 6}, {6, 12}}));
}

TEST(Slicer, CutsAtReferenceImagesThatComeEarlyOrLate) {
    const Edges expected{{0, 40}, {40, 80}, {80, 120}, {120, 130}};
    std::vector<Event> events;
    for (int t = 1; t <= 130; ++t) events.push_back(at(t));
    EXPECT_EQ(edges_of(slices_of(by_reference(1000), events, {40, 80, 120})), expected);
    for (const std::ptrdiff_t delay : {0, 1, 5, 30, 60}) {
        SCOPED_TRACE(delay);
        Slicer slicer(by_reference(1000), 240, 180);
        std::vector<Kept> slices;
        for (const Event& event : events) {
            slicer.push({&event, 1});
            const auto t = to_us(event.t) - delay;
            if (t > 0 && t % 40 == 0) slicer.push_reference(from_us(t));
            take(slicer, slices);
        }
        for (const std::int64_t t : {40, 80, 120})
            if (t + delay > 130) slicer.push_reference(from_us(t));
        slicer.finish();
        take(slicer, slices);
        EXPECT_EQ(edges_of(slices), expected);
        EXPECT_EQ(slicer.counters().late_references, 0U);
    }
}

TEST(Slicer, CutsAtAnImageOnlyWhenTheStreamHasPassedIt) {
    Slicer slicer(by_reference(1000), 240, 180);
    slicer.push_reference(from_us(40));
    const std::vector<Event> first{at(1), at(40)}, second{at(40)}, third{at(41)};
    std::vector<Kept> slices;
    for (const auto& events : {first, second}) {
        slicer.push(events);
        take(slicer, slices);
        EXPECT_TRUE(slices.empty()) << "more events of that microsecond may come";
    }
    slicer.push(third);
    take(slicer, slices);
    ASSERT_EQ(slices.size(), 1U);
    EXPECT_EQ(slices[0].events.size(), 3U);
}

TEST(Slicer, WaitsForALateImageAsLongAsItSaysThenCutsAtTheMaximumWidth) {
    Slicer slicer(by_reference(100, 50), 240, 180);
    std::vector<Kept> slices;
    const std::vector<Event> first{at(1)};
    slicer.push(first);
    slicer.advance(from_us(150));
    take(slicer, slices);
    EXPECT_TRUE(slices.empty());
    slicer.advance(from_us(151));
    take(slicer, slices);
    EXPECT_EQ(edges_of(slices), (Edges{{0, 100}}));
    slicer.push_reference(from_us(60));
    EXPECT_EQ(slicer.counters().late_references, 1U);
}

TEST(Slicer, ClosesFramesInSilenceByTheClock) {
    Slicer slicer(by_duration(10), 240, 180);
    std::vector<Kept> slices;
    const std::vector<Event> one{at(1)};
    slicer.push(one);
    slicer.advance(from_us(10));
    take(slicer, slices);
    EXPECT_TRUE(slices.empty()) << "more events at 10 may come";
    for (int t = 11; t <= 35; ++t) {
        slicer.advance(from_us(t));
        take(slicer, slices);
    }
    EXPECT_EQ(edges_of(slices), (Edges{{0, 10}, {10, 20}, {20, 30}}));
    slicer.advance(from_us(20));  // a clock that goes back a little changes nothing
    slicer.finish();
    take(slicer, slices);
    EXPECT_EQ(slices.back().end_us, 35);
}

TEST(Slicer, BeginsWithTheClockWhereNoEventHasComeYet) {
    Slicer slicer(by_duration(10), 240, 180);
    EXPECT_FALSE(slicer.has_begun());
    std::vector<Kept> slices;
    slicer.advance(from_us(101));
    slicer.advance(from_us(111));
    take(slicer, slices);
    EXPECT_EQ(edges_of(slices), (Edges{{100, 110}}));
}

TEST(Slicer, AJumpOfHoursGivesAHandfulOfFrames) {
    constexpr std::int64_t kHours = 5 * 3'600'000'000LL;
    for (const SlicerSettings& settings :
         {by_duration(1000), by_count(10, 1000), by_reference(1000)}) {
        const auto slices = slices_of(settings, {at(1), at(kHours + 1), at(kHours + 2)});
        ASSERT_EQ(slices.size(), 1U + 16U + 1U + 1U);
        EXPECT_EQ(slices[0].events.size(), 1U);
        EXPECT_EQ(slices[16].end_us - slices[16].begin_us, 1000);
        EXPECT_EQ(slices[17].end_us % 1000, 0) << "later edges stay where they would have been";
        EXPECT_EQ(slices[17].end_us, slices[18].begin_us);
        EXPECT_LE(kHours - slices[18].begin_us, 1000);
        EXPECT_EQ(slices[18].events.size(), 2U);
    }
}

TEST(Slicer, EndsALongSilenceAtAReferenceImage) {
    const auto slices = slices_of(by_reference(10), {at(1), at(10'000)}, {5'005});
    const auto edge = std::find_if(slices.begin(), slices.end(),
                                   [](const Kept& slice) { return slice.end_us == 5'005; });
    EXPECT_NE(edge, slices.end());
    EXPECT_LT(slices.size(), 60U);
}

TEST(Slicer, MarksTheSliceAfterALoss) {
    Slicer slicer(by_duration(10), 240, 180);
    std::vector<Kept> slices;
    const std::vector<Event> before{at(1), at(12)}, after{at(38)};
    slicer.push(before);
    take(slicer, slices);
    slicer.mark_gap();
    slicer.push(after);
    take(slicer, slices);
    ASSERT_EQ(slices.size(), 3U);
    EXPECT_FALSE(slices[0].gap);
    EXPECT_TRUE(slices[1].gap);
    EXPECT_FALSE(slices[2].gap);
}

TEST(Slicer, TimeGoingBackEndsTheStreamAndBeginsANewOne) {
    const auto slices = slices_of(by_duration(10), {at(1001), at(1013), at(5), at(21), at(3)});
    EXPECT_EQ(edges_of(slices), (Edges{{1000, 1010}, {1010, 1013}, {4, 14}, {14, 21}, {2, 3}}));
    EXPECT_EQ(slices[1].reset, false);
    EXPECT_EQ(slices[2].reset, true);
    EXPECT_EQ(slices[3].reset, false);
    EXPECT_EQ(slices[4].reset, true);
}

TEST(Slicer, KeepsToTheAskedSpan) {
    SlicerSettings settings = by_duration(10);
    settings.begin = from_us(100);
    settings.end = from_us(125);
    Slicer slicer(settings, 240, 180);
    const std::vector<Event> events{at(90), at(100), at(101), at(125), at(126), at(400)};
    slicer.push(events);
    EXPECT_TRUE(slicer.is_past_end());
    std::vector<Kept> slices;
    take(slicer, slices);
    EXPECT_EQ(edges_of(slices), (Edges{{100, 110}, {110, 120}, {120, 125}}));
    EXPECT_EQ(slices[0].events.size(), 1U);
    EXPECT_EQ(slices[2].events.size(), 1U);
    EXPECT_EQ(slicer.counters().before_begin, 2U);
    EXPECT_EQ(slicer.counters().after_end, 2U);
}

TEST(Slicer, EndsAStreamOfUnknownTimesAfterADurationInSilenceToo) {
    SlicerSettings settings = by_duration(100);
    settings.duration = SensorDuration{250};
    Slicer slicer{settings, 240, 180};
    std::vector<Kept> slices;
    slicer.push(std::vector{at(1001, 1)});
    slicer.advance(from_us(1200));
    take(slicer, slices);
    EXPECT_FALSE(slicer.is_past_end());
    slicer.advance(from_us(5000));
    take(slicer, slices);
    EXPECT_TRUE(slicer.is_past_end());
    EXPECT_EQ(edges_of(slices), (Edges{{1000, 1100}, {1100, 1200}, {1200, 1250}}));
}

TEST(Slicer, MovesAnEventThatComesAfterItsFrameWasClosed) {
    Slicer slicer(by_duration(10), 240, 180);
    std::vector<Kept> slices;
    const std::vector<Event> first{at(1)}, late{at(7), at(29)};
    slicer.push(first);
    slicer.advance(from_us(25));
    take(slicer, slices);
    slicer.push(late);
    slicer.finish();
    take(slicer, slices);
    EXPECT_EQ(slicer.counters().late, 1U);
    ASSERT_EQ(slices.size(), 3U);
    EXPECT_EQ(slices[2].events, (std::vector{at(21), at(29)}));
}

TEST(Slicer, BoundsMemoryByEndingFramesAndLeavingOutWhatNoCameraSends) {
    SlicerSettings settings = by_duration(1000);
    settings.max_events = 4;
    std::vector<Event> events(10, at(1));
    for (int t = 2; t < 12; ++t) events.push_back(at(t));
    Slicer slicer(settings, 240, 180);
    slicer.push(events);
    slicer.finish();
    std::vector<Kept> slices;
    take(slicer, slices);
    EXPECT_EQ(slicer.counters().too_many, 6U);
    EXPECT_EQ(edges_of(slices), (Edges{{0, 1}, {1, 5}, {5, 9}, {9, 11}}));
    for (const Kept& slice : slices) EXPECT_LE(slice.events.size(), 4U);
}

TEST(Slicer, ResetIsAsConstructed) {
    std::mt19937 rng{5};
    const auto events = eventful_stream(rng);
    Slicer slicer(by_duration(1000), 240, 180);
    slicer.push(events);
    slicer.mark_gap();
    slicer.finish();
    slicer.reset();
    slicer.push(events);
    std::vector<Kept> slices;
    take(slicer, slices);
    slicer.finish();
    take(slicer, slices);
    EXPECT_EQ(slices, slices_of(by_duration(1000), events));
}

TEST(Slicer, AnEmptyStreamHasNoFrames) {
    for (const SlicerSettings& settings : {by_duration(10), by_count(5), by_reference(10)})
        EXPECT_TRUE(slices_of(settings, {}).empty());
}

TEST(Slicer, RefusesSettingsOutOfRange) {
    EXPECT_THROW(Slicer(by_duration(0), 2, 2), Error);
    EXPECT_THROW(Slicer(by_count(0), 2, 2), Error);
    EXPECT_THROW(Slicer(by_count(5, 0), 2, 2), Error);
    EXPECT_THROW(Slicer(by_duration(10), 0, 2), Error);
}

}  // namespace
}  // namespace eventide
