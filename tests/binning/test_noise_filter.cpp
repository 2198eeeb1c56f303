#include "src/binning/noise_filter.h"

#include "src/core/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <utility>

namespace eventide {
namespace {

using Events = std::vector<Event>;

Event at(std::int64_t us, int x, int y) {
    return {from_us(us), std::uint16_t(x), std::uint16_t(y), Polarity::on};
}

Events filtered(NoiseFilter filter, Events events) {
    filter.process(events);
    return events;
}

NoiseFilterSettings constant(int us) {
    return {SensorDuration{us}, SensorDuration{us}};
}

NoiseFilter small_filter() {
    return {8, 6, constant(1000)};
}

Events random_events(int n, int width, int height, double us_between) {
    std::mt19937 random{7};
    std::exponential_distribution<double> pause{1 / us_between};
    Events events;
    double t = 0;
    for (int i = 0; i < n; ++i) {
        events.push_back(at(std::int64_t(t += pause(random)), int(random() % unsigned(width)),
                            int(random() % unsigned(height))));
        events.back().polarity = random() % 2 == 0 ? Polarity::on : Polarity::off;
    }
    return events;
}

/// In order of time.
Events together(Events some, const Events& others) {
    some.insert(some.end(), others.begin(), others.end());
    std::ranges::stable_sort(some, {}, &Event::t);
    return some;
}

TEST(NoiseFilter, AnEventStaysWhereTwoOfItsNeighboursJustHadOne) {
    const Events events{at(0, 2, 2), at(10, 3, 2), at(20, 3, 3), at(1009, 2, 3)};
    // The third has two neighbours, the fourth all three within 1 ms less the first.
    EXPECT_EQ(filtered(small_filter(), events),
              (Events{at(0, 2, 2), at(20, 3, 3), at(1009, 2, 3)}));
}

TEST(NoiseFilter, WhatLiesFartherInSpaceOrTimeSupportsNothing) {
    EXPECT_EQ(filtered(small_filter(), {at(0, 1, 1), at(1, 2, 1), at(1002, 2, 2)}).size(), 1U);
    EXPECT_EQ(filtered(small_filter(), {at(0, 0, 2), at(1, 4, 2), at(2, 2, 2)}).size(), 1U);
}

TEST(NoiseFilter, APixelDoesNotSupportItself) {
    EXPECT_EQ(filtered(small_filter(), {at(0, 2, 2), at(1, 2, 2), at(2, 2, 2)}).size(), 1U);
}

TEST(NoiseFilter, RowsDoNotNeighbourAcrossTheSensorsEdge) {
    EXPECT_EQ(filtered(small_filter(), {at(0, 7, 1), at(1, 7, 2), at(2, 0, 2)}).size(), 1U);
    EXPECT_EQ(filtered(small_filter(), {at(0, 0, 0), at(1, 7, 5), at(2, 6, 5), at(3, 7, 4)}),
              (Events{at(0, 0, 0), at(3, 7, 4)}));
}

TEST(NoiseFilter, TheFirstEventOfAStreamStays) {
    // At 0, and where the clock is back at 0.
    EXPECT_EQ(filtered(small_filter(), {at(0, 1, 1), at(5000, 4, 4), at(0, 2, 2), at(4999, 3, 3)}),
              (Events{at(0, 1, 1), at(0, 2, 2)}));
}

TEST(NoiseFilter, EventsFromBeforeAClockWasResetSupportNothing) {
    NoiseFilter filter = small_filter();
    Events before{at(5000, 2, 2), at(5001, 3, 2)};
    filter.process(before);
    Events after{at(4900, 0, 5), at(4901, 2, 3)};
    filter.process(after);
    EXPECT_EQ(after, (Events{at(4900, 0, 5)}));
}

/// Times of another stream that look as if they had just been.
TEST(NoiseFilter, NorDoThoseWhoseTimesComeBeforeThem) {
    const Events events{at(1000, 2, 2), at(1001, 3, 2), at(400'000, 0, 5), at(1500, 6, 0),
                        at(1501, 2, 3)};
    EXPECT_EQ(filtered(small_filter(), events), (Events{at(1000, 2, 2), at(1500, 6, 0)}));
}

TEST(NoiseFilter, DoesNotCareHowTheEventsAreSplit) {
    const Events all = random_events(5000, 20, 10, 50);
    const Events expected = filtered({20, 10, constant(1000)}, all);
    EXPECT_GT(expected.size(), 100U);
    EXPECT_LT(expected.size(), 4900U);
    NoiseFilter filter{20, 10, constant(1000)};
    Events split;
    std::mt19937 random{3};
    for (std::size_t i = 0; i < all.size();) {
        const std::size_t n = std::min<std::size_t>(all.size() - i, random() % 70);
        Events part(all.begin() + std::ptrdiff_t(i), all.begin() + std::ptrdiff_t(i + n));
        filter.process(part);
        split.insert(split.end(), part.begin(), part.end());
        i += n;
    }
    EXPECT_EQ(split.size(), expected.size());
    EXPECT_TRUE(split == expected);
}

TEST(NoiseFilter, KeepsTheMovingEdgeAndLeavesOutTheNoise) {
    // 2 events per pixel and second of noise; an edge of the sensor's height that moves at 1 px/ms.
    constexpr int kSide = 64;
    Events noise = random_events(500, kSide, kSide, 1e6 / (2. * kSide * kSide));
    EXPECT_LT(filtered({kSide, kSide, constant(10'000)}, noise).size(), 25U);
    Events edge;
    for (int x = 0; x < kSide; ++x)
        for (int y = 0; y < kSide; ++y) edge.push_back(at(1000 * x + y, x, y));
    EXPECT_GT(double(filtered({kSide, kSide, constant(10'000)}, edge).size()),
              double(edge.size()) * .95);
}

TEST(NoiseFilter, LearnsTheNoiseAndChoosesTheTimeByIt) {
    constexpr int kSide = 64;
    NoiseFilter filter{kSide, kSide, {}};
    EXPECT_EQ(filter.noise_hz(), 2) << "until it is known";
    Events noise = random_events(40'000, kSide, kSide, 1e6 / (1. * kSide * kSide));  // 1 Hz, 9.8 s
    filter.process(noise);
    EXPECT_LT(filter.noise_hz(), 1) << "the quietest parts tell it";
    EXPECT_GT(filter.noise_hz(), .5);
    EXPECT_NEAR(double(filter.within().count()), .4e6 / (8 * filter.noise_hz()), 1);
    Events silence{at(20'000'000, 1, 1)};
    filter.process(silence);
    EXPECT_EQ(filter.noise_hz(), 0);
}

TEST(NoiseFilter, LearnsTheNoiseAtOnceWhereTheClockBeganAnew) {
    constexpr int kSide = 64;
    const Events loud = random_events(160'000, kSide, kSide, 1e6 / (8. * kSide * kSide));  // 5 s
    const Events quiet = random_events(2'000, kSide, kSide, 1e6 / (1. * kSide * kSide));   // .5 s
    NoiseFilter filter{kSide, kSide, {}};
    Events events = loud;
    filter.process(events);
    EXPECT_GT(filter.noise_hz(), 5);
    events = quiet;
    filter.process(events);
    EXPECT_LT(filter.noise_hz(), 1.4);
}

/// What is known of the noise halves with each quarter of a second, down to nothing.
TEST(NoiseFilter, WithoutNoiseNeighboursSupportForAsLongAsTheyMay) {
    NoiseFilter filter{64, 64, {}};
    Events noise = random_events(4000, 64, 64, 1e6 / (2. * 64 * 64));
    filter.process(noise);
    ASSERT_GT(filter.noise_hz(), .5);
    for (int i = 10; i < 6000; ++i) {
        Events one{at(200'000 * i, 20, 20)};
        filter.process(one);
        if (i < 40) continue;
        ASSERT_EQ(filter.within(), NoiseFilterSettings{}.longest) << filter.noise_hz() << " Hz";
        ASSERT_EQ(filter.quiet_within(), NoiseFilterSettings{}.longest)
            << filter.noise_hz() << " Hz";
    }
    EXPECT_EQ(filter.noise_hz(), 0);
}

TEST(NoiseFilter, LearnsTheNoiseOfASensorThatIsNarrowerThanTwoTiles) {
    for (const auto& [width, height] : {std::pair{15, 15}, {5, 90}, {14, 96}, {96, 13}}) {
        NoiseFilter filter{width, height, {}};
        Events noise = random_events(40 * width * height, width, height, 1e6 / (width * height));
        filter.process(noise);  // 1 Hz, 40 s
        EXPECT_GT(filter.noise_hz(), .6) << width << 'x' << height;
        EXPECT_LT(filter.noise_hz(), 1.4) << width << 'x' << height;
    }
}

TEST(NoiseFilter, KeepsSlowMotionWhereThereIsNoNoise) {
    // An edge that moves at 50 ms per pixel, every pixel at its own time: most are alone for 10 ms.
    constexpr int kSide = 48;
    std::mt19937 random{11};
    Events slow;
    for (int x = 0; x < 40; ++x) {
        Events column;
        for (int y = 0; y < kSide; ++y)
            column.push_back(at(50'000 * x + int(random() % 50'000), x, y));
        std::ranges::sort(column, {}, &Event::t);
        slow.insert(slow.end(), column.begin(), column.end());
    }
    EXPECT_GT(double(filtered({kSide, kSide, {}}, slow).size()), double(slow.size()) * .85);
    EXPECT_LT(double(filtered({kSide, kSide, constant(10'000)}, slow).size()),
              double(slow.size()) * .5);
}

TEST(NoiseFilter, LeavesOutTheNoiseOfAStillSceneAndKeepsWhatMovesInIt) {
    // 1 Hz of noise, three times that in one quarter: once learned, next to nothing of it stays.
    constexpr int kSide = 64;
    NoiseFilter filter{kSide, kSide, {}};
    const Events noise = together(random_events(60'000, kSide, kSide, 1e6 / (1. * kSide * kSide)),
                                  random_events(30'000, 32, 32, 1e6 / (2. * 32 * 32)));
    const SensorTime learned = from_us(10'000'000), moves = from_us(14'000'000);
    Events events;
    for (const Event& event : noise)
        if (event.t < moves) events.push_back(event);
    const auto later = std::size_t(
        std::ranges::count_if(events, [&](const Event& event) { return event.t >= learned; }));
    filter.process(events);
    const auto kept = std::size_t(
        std::ranges::count_if(events, [&](const Event& event) { return event.t >= learned; }));
    EXPECT_GT(later, 20'000U);
    EXPECT_LT(kept, later / 1000);
    Events edge;
    for (int x = 0; x < kSide; ++x)
        for (int y = 0; y < kSide; ++y) edge.push_back(at(14'000'000 + 1000 * x + y, x, y));
    const std::size_t all = edge.size();
    filter.process(edge);
    EXPECT_GT(edge.size(), all * 9 / 10);
}

TEST(NoiseFilter, WhatFiresFarMoreThanTheRestIsNoNoiseHoweverLongItGoesOn) {
    // 1 Hz of noise for 20 s; one part of the sensor fires seven times as much, and alone.
    constexpr int kSide = 64;
    NoiseFilter filter{kSide, kSide, {}};
    Events events = together(random_events(80'000, kSide, kSide, 1e6 / (1. * kSide * kSide)),
                             random_events(7'680, 8, 8, 1e6 / (6. * 8 * 8)));
    filter.process(events);
    const std::vector<NoiseFilter::Tile> tiles = filter.state().tiles;
    const double quiet = filter.noise_hz() * 8 * 8 * .25;  // events of a tile and an interval
    EXPECT_GT(quiet, 0);
    for (const NoiseFilter::Tile& tile : tiles) {
        EXPECT_GE(tile.noise, quiet * .999);
        EXPECT_LE(tile.noise, 4 * quiet * 1.001);
    }
}

TEST(NoiseFilter, LeavesOutHotPixelsAndTheirSupport) {
    constexpr int kSide = 32;
    Events events = random_events(10'000, kSide, kSide, 1e6 / (1. * kSide * kSide));
    for (int ms = 0; ms < 9000; ms += 5)
        for (int x : {10, 11}) events.push_back(at(1000 * ms + x, x, 20));
    std::ranges::stable_sort(events, {}, &Event::t);
    const Events kept = filtered({kSide, kSide, {}}, events);
    EXPECT_EQ(std::ranges::count_if(kept,
                                    [](const Event& event) {
                                        return event.t > from_us(4'000'000) && event.y > 17 &&
                                               event.y < 23 && event.x > 7 && event.x < 14;
                                    }),
              0);
}

/// One event a second between two pixels that fire every 5 ms.
TEST(NoiseFilter, TwoPixelsSupportAnEventUntilTheyAreKnownToBeHot) {
    Events events;
    for (int ms = 0; ms < 9000; ms += 5)
        for (const int x : {10, 12}) events.push_back(at(1000 * ms + x, x, 20));
    for (int s = 1; s < 9; ++s) events.push_back(at(1'000'000 * s + 100, 11, 20));
    std::ranges::stable_sort(events, {}, &Event::t);
    std::vector<std::int64_t> kept;
    for (const Event& event : filtered({32, 32, constant(1000)}, events))
        if (event.x == 11) kept.push_back(to_us(event.t));
    EXPECT_EQ(kept, (std::vector<std::int64_t>{1'000'100}));
}

TEST(NoiseFilter, KnowsNothingOfWhatWasBeforeAReset) {
    constexpr int kSide = 32;
    Events before = random_events(20'000, kSide, kSide, 1e6 / (4. * kSide * kSide));
    for (int ms = 0; ms < 4000; ms += 5) before.push_back(at(1000 * ms, 10, 20));
    std::ranges::stable_sort(before, {}, &Event::t);
    Events after;
    for (const Event& event : random_events(5000, kSide, kSide, 1e6 / (1. * kSide * kSide)))
        after.push_back({event.t + SensorDuration{6'000'000}, event.x, event.y, event.polarity});
    for (const NoiseFilterSettings& settings : {NoiseFilterSettings{}, constant(10'000)}) {
        NoiseFilter filter{kSide, kSide, settings};
        const NoiseFilter::State fresh = filter.state();
        filter.process(before);
        EXPECT_FALSE(filter.state() == fresh);
        filter.reset();
        EXPECT_TRUE(filter.state() == fresh);
        Events kept = after;
        filter.process(kept);
        EXPECT_TRUE(kept == filtered({kSide, kSide, settings}, after));
    }
}

TEST(NoiseFilter, TakesSensorsOfAnySize) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 640}, {17, 13}, {9, 8}})
        EXPECT_LE(filtered({width, height, {}}, random_events(3000, width, height, 300)).size(),
                  3000U);
}

TEST(NoiseFilter, IsChosenByAWordOrATime) {
    EXPECT_EQ(parse_noise_filter("off", true), std::nullopt);
    EXPECT_EQ(parse_noise_filter("auto", false), NoiseFilterSettings{});
    EXPECT_EQ(parse_noise_filter("model", true), NoiseFilterSettings{});
    EXPECT_EQ(parse_noise_filter("model", false), std::nullopt);
    EXPECT_EQ(parse_noise_filter("2.5ms", false), constant(2500));
    for (const char* bad : {"", "on", "10", "0ms", "-1ms", "11s", "nan s", "1 ms"})
        EXPECT_THROW(parse_noise_filter(bad, true), Error) << bad;
    EXPECT_EQ(noise_filter_text(*parse_noise_filter("auto", false)), "auto");
    EXPECT_EQ(noise_filter_text(*parse_noise_filter("20ms", false)), "20ms");
    EXPECT_THROW((NoiseFilter{4, 4, constant(0)}), Error);
    EXPECT_THROW((NoiseFilter{4, 4, constant(10'000'001)}), Error);
    EXPECT_THROW((NoiseFilter{4, 4, {SensorDuration{2}, SensorDuration{1}}}), Error);
}

}  // namespace
}  // namespace eventide
