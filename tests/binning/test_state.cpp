// What slicer, noise filter and binner remember: another one goes on with it as the first would
// have.
#include "src/binning/binner.h"
#include "src/binning/noise_filter.h"
#include "src/core/error.h"
#include "tests/binning/event_windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace eventide {
namespace {

/// `n` events on a sensor of 240 x 180 px, some together, with pauses.
std::vector<Event> lively(int n, unsigned seed) {
    std::mt19937 random{seed};
    std::vector<Event> events;
    std::int64_t us = 1'000'000;
    for (int i = 0; i < n; ++i) {
        us += random() % 1000 == 0 ? 90'000 : std::int64_t(random() % 60);
        const bool cluster = random() % 3 != 0;
        events.push_back({from_us(us), std::uint16_t(cluster ? 40 + random() % 6 : random() % 240),
                          std::uint16_t(cluster ? 50 + random() % 6 : random() % 180),
                          random() % 2 == 0 ? Polarity::on : Polarity::off});
    }
    return events;
}

std::vector<Event> part(const std::vector<Event>& events, std::size_t from, std::size_t to) {
    return {events.begin() + std::ptrdiff_t(from), events.begin() + std::ptrdiff_t(to)};
}

std::vector<SlicerSettings> rules() {
    return {by_duration(7000), by_count(300, 20'000), by_content(.01)};
}

TEST(SlicerState, AnotherGoesOnWithTheSameWindows) {
    const std::vector<Event> events = lively(5000, 3);
    for (const SlicerSettings& settings : rules())
        for (const std::size_t stop : {1U, 700U, 2500U, 4999U}) {
            Slicer first{settings, 240, 180}, second{settings, 240, 180};
            std::vector<Kept> ours, theirs;
            first.push(part(events, 0, stop));
            take(first, ours);
            if (stop > 1) first.mark_gap();
            const auto state = first.state();
            ASSERT_TRUE(state);
            second.restore(*state);
            EXPECT_EQ(second.state(), state);
            ours.clear();
            for (Slicer* slicer : {&first, &second}) {
                std::vector<Kept>& into = slicer == &first ? ours : theirs;
                slicer->push(part(events, stop, events.size()));
                take(*slicer, into);
                slicer->finish();
                take(*slicer, into);
            }
            EXPECT_EQ(ours, theirs) << stop;
            ASSERT_FALSE(ours.empty());
            EXPECT_EQ(ours.front().gap, stop > 1) << "what was lost before is told after";
        }
}

TEST(SlicerState, WhatAFilterHeldBackComesYetThoughItIsBeforeTheBeginAskedFor) {
    Slicer first{by_duration(1000), 240, 180};
    first.push(std::vector{at(1), at(2500)});
    std::vector<Kept> windows;
    take(first, windows);  // until 2000 us
    SlicerSettings settings = by_duration(1000);
    settings.begin = from_us(2600);
    Slicer second{settings, 240, 180};
    second.restore(*first.state());
    second.push(std::vector{at(2550), at(3100)});
    second.finish();
    windows.clear();
    take(second, windows);
    ASSERT_EQ(windows.size(), 2U);
    EXPECT_EQ(windows[0].events.size(), 2U);
}

TEST(SlicerState, AnEventFromBeforeAWindowThatHasJustBegunIsNotLost) {
    Slicer slicer{by_duration(1000), 240, 180};
    slicer.restore(
        {from_us(1000), from_us(0), from_us(1000), from_us(900), from_us(900), 1, 0, false, {}});
    slicer.push(std::vector{at(950)});
    slicer.finish();
    std::vector<Kept> windows;
    take(slicer, windows);
    ASSERT_EQ(windows.size(), 1U);
    EXPECT_EQ(windows[0].events.size(), 1U);
    EXPECT_EQ(slicer.counters().late, 1U);
}

TEST(SlicerState, ThereIsNoneOfWhatCannotGoOn) {
    Slicer empty{by_duration(1000), 240, 180}, images{by_reference(1000), 240, 180},
        reset{by_duration(1000), 240, 180};
    EXPECT_FALSE(empty.state());
    images.push(std::vector{at(5)});
    EXPECT_FALSE(images.state());
    reset.push(std::vector{at(5000), at(7)});
    std::vector<Kept> kept;
    take(reset, kept);
    EXPECT_FALSE(reset.state()) << "its clock began anew";
}

TEST(SlicerState, EventsAfterTheEndAreNoPartOfIt) {
    SlicerSettings settings = by_duration(1000);
    settings.end = from_us(1500);
    Slicer first{settings, 240, 180}, second{by_duration(1000), 240, 180};
    std::vector<Kept> windows;
    first.push(std::vector{at(700), at(1500), at(1600), at(1600), at(9000)});
    take(first, windows);
    const auto state = first.state();
    ASSERT_TRUE(state);
    EXPECT_EQ(state->newest_event, from_us(1500));
    EXPECT_EQ(state->same_time, 1U);
    second.restore(*state);
    EXPECT_EQ(second.state(), state);
}

TEST(SlicerState, WhatHoldsNoTruthIsRefused) {
    Slicer slicer{by_duration(1000), 240, 180};
    Slicer::State good{
        from_us(1000), from_us(0),          from_us(1500), from_us(1500), from_us(1500), 1, 0,
        false,         {at(1200), at(1500)}};
    slicer.restore(good);
    const auto refused = [&](auto spoil) {
        Slicer::State bad = good;
        spoil(bad);
        EXPECT_THROW(slicer.restore(bad), Error);
        EXPECT_EQ(slicer.state(), good) << "as it was";
    };
    refused([](auto& m) { m.origin = from_us(2000); });
    refused([](auto& m) { m.newest = from_us(900); });
    refused([](auto& m) { m.newest_event = from_us(1600); });
    refused([](auto& m) { m.silent = -1; });
    refused([](auto& m) { m.newest = m.newest_event = from_us(std::int64_t{1} << 61); });
    refused([](auto& m) { m.origin = SensorTime::min(); });
    refused([](auto& m) { m.events.front().t = from_us(1000); });
    refused([](auto& m) { std::ranges::reverse(m.events); });
}

TEST(NoiseFilterState, AnotherLeavesOutTheSame) {
    const std::vector<Event> events = lively(40'000, 4);
    for (const std::size_t stop : {1U, 12'345U, 39'000U}) {
        NoiseFilter first{240, 180, {}}, second{240, 180, {}};
        std::vector<Event> before = part(events, 0, stop);
        first.process(before);
        const NoiseFilter::State state = first.state();
        second.restore(state);
        EXPECT_EQ(second.state(), state);
        EXPECT_EQ(second.within(), first.within());
        std::vector<Event> ours = part(events, stop, events.size()), theirs = ours;
        NoiseFilter fresh{240, 180, {}};
        std::vector<Event> without = ours;
        first.process(ours);
        second.process(theirs);
        fresh.process(without);
        EXPECT_EQ(ours, theirs) << stop;
        if (stop > 1) {
            EXPECT_NE(ours, without) << "the detector detects";
        }
    }
}

/// As a file may say it that was written by something else.
TEST(NoiseFilterState, WithoutAnIntervalOneBeginsWithTheNextEvent) {
    NoiseFilter filter{240, 180, {}};
    std::vector<Event> events = lively(2'000, 4);
    filter.process(events);
    NoiseFilter::State state = filter.state();
    const SensorTime next = *state.last + SensorDuration{10};
    state.interval.reset();
    filter.restore(state);
    std::vector<Event> later{{next, 3, 3, Polarity::on}};
    filter.process(later);
    EXPECT_EQ(filter.state().interval, next);
}

TEST(NoiseFilterState, OfAnotherSensorIsRefused) {
    NoiseFilter filter{240, 180, {}};
    EXPECT_THROW(filter.restore(NoiseFilter{180, 200, {}}.state()), Error);
    const auto refused = [&](auto spoil) {
        NoiseFilter::State bad = filter.state();
        spoil(bad);
        EXPECT_THROW(filter.restore(bad), Error);
    };
    refused([](auto& bad) { bad.newest.pop_back(); });
    refused([](auto& bad) { bad.polarity.pop_back(); });
    refused([](auto& bad) { bad.tiles.pop_back(); });
    refused([](auto& bad) { bad.hot_pixels.events.pop_back(); });
    refused([](auto& bad) { bad.hot_pixels.hot.pop_back(); });
}

TEST(BinnerState, AnotherKnowsTheAges) {
    Binner first{3, 180, 240}, second{3, 180, 240}, fresh{3, 180, 240};
    VoxelGrid ours = first.make_output(), theirs = second.make_output(),
              without = fresh.make_output();
    const std::vector<Event> events = lively(300, 5);
    first.process({{from_us(0), from_us(2'000'000)}, events}, ours);
    second.restore(first.ages());
    const EventWindow next{{from_us(2'000'000), from_us(3'000'000)}, {}};
    first.process(next, ours);
    second.process(next, theirs);
    fresh.process(next, without);
    EXPECT_TRUE(std::ranges::equal(ours.values.values(), theirs.values.values()));
    EXPECT_FALSE(std::ranges::equal(ours.values.values(), without.values.values()));
    EXPECT_THROW(second.restore(std::vector<std::uint8_t>(7)), Error);
}

}  // namespace
}  // namespace eventide
