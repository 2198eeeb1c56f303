// The binner against a brute-force oracle in double precision, and against itself: order, absolute
// time, splits.
#include "src/binning/binner.h"
#include "src/core/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <vector>

namespace eventide {
namespace {

constexpr int kHeight = 5, kWidth = 7;
constexpr std::int64_t kEpoch = 1'700'000'000'000'000;  // 2023, in us

EventWindow event_window_of(const std::vector<Event>& events, std::int64_t begin_us,
                            std::int64_t width_us) {
    return {{from_us(begin_us), from_us(begin_us + width_us)}, events};
}

Event event(std::int64_t t_us, int x, int y, bool on = true) {
    return {from_us(t_us), std::uint16_t(x), std::uint16_t(y), on ? Polarity::on : Polarity::off};
}

/// Straight from the definition: two passes over the events of each voxel, in long double.
Array3<float> oracle(const EventWindow& event_window, int bins, int height, int width) {
    Array3<float> grid(height, width, 4 * bins + 1);
    const auto frame = (long double)(event_window.window.width().count());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int b = 0; b < bins; ++b) {
                long double polarity = 0, sum = 0, squares = 0, n = 0;
                std::vector<long double> f;
                for (const Event& e : event_window.events) {
                    if (e.x != x || e.y != y) continue;
                    const auto place =
                        (long double)((e.t - event_window.window.begin).count()) * bins / frame - b;
                    if (place <= 0 || place > 1) continue;  // bins are (begin, end], as frames are
                    f.push_back(place);
                    polarity += e.polarity == Polarity::on ? 1 : -1;
                    sum += place;
                    n += 1;
                }
                for (const long double place : f) squares += std::pow(place - sum / n, 2.0L);
                if (n == 0) continue;
                grid(y, x, 4 * b) = float(polarity);
                grid(y, x, 4 * b + 1) = float(sum / n);
                grid(y, x, 4 * b + 2) = float(std::sqrt(squares / n));
                grid(y, x, 4 * b + 3) = float(n);
            }
    return grid;
}

std::vector<Event> random_events(std::mt19937& rng, std::int64_t begin_us, std::int64_t width_us,
                                 std::size_t n) {
    std::uniform_int_distribution<std::int64_t> dt{1, width_us};
    std::vector<Event> events;
    for (std::size_t i = 0; i < n; ++i)
        events.push_back(
            event(begin_us + dt(rng), int(rng() % kWidth), int(rng() % kHeight), rng() % 2 == 0));
    std::sort(events.begin(), events.end(),
              [](const Event& a, const Event& b) { return a.t < b.t; });
    return events;
}

VoxelGrid grid_of(const EventWindow& event_window, int bins, int height = kHeight,
                  int width = kWidth) {
    Binner binner(bins, height, width);
    VoxelGrid grid = binner.make_output();
    binner.process(event_window, grid);
    return grid;
}

void expect_near_oracle(const EventWindow& event_window, int bins, float tolerance) {
    const VoxelGrid grid = grid_of(event_window, bins);
    const Array3<float> expected = oracle(event_window, bins, kHeight, kWidth);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 4 * bins; ++c)
                ASSERT_NEAR(grid.values(y, x, c), expected(y, x, c),
                            tolerance * std::max(1.0F, std::abs(expected(y, x, c))))
                    << "at " << y << ' ' << x << " channel " << c;
}

TEST(Binner, AgreesWithTheOracleOnRandomStreams) {
    std::mt19937 rng{1};
    for (const int bins : {1, 2, 3, 5, 10, 13, 64})
        for (const std::int64_t width_us : {1, 7, 100, 50'000, 333'333, 524'287}) {
            SCOPED_TRACE(testing::Message() << bins << " bins, " << width_us << " us");
            const auto events = random_events(rng, kEpoch, width_us, 500);
            // Two roundings to float, and one of the double in between.
            expect_near_oracle(event_window_of(events, kEpoch, width_us), bins, 2e-7F);
        }
}

TEST(Binner, AgreesWithTheOracleOnWindowsOfHoursUpToItsStatedResolution) {
    std::mt19937 rng{2};
    for (const std::int64_t width_us : {1'000'000LL, 3'600'000'000LL, 1'000'000'000'000'000LL}) {
        SCOPED_TRACE(width_us);
        const auto events = random_events(rng, kEpoch, width_us, 500);
        expect_near_oracle(event_window_of(events, kEpoch, width_us), 5, 4e-6F);
    }
}

TEST(Binner, PutsEventsOnBinEdgesIntoTheEarlierBin) {
    const std::vector<Event> events{event(1, 0, 0), event(50, 0, 0), event(51, 1, 0),
                                    event(100, 1, 0)};
    const VoxelGrid grid = grid_of(event_window_of(events, 0, 100), 2);
    EXPECT_EQ(grid.values(0, 0, 3), 2);
    EXPECT_EQ(grid.values(0, 0, 7), 0);
    EXPECT_EQ(grid.values(0, 1, 3), 0);
    EXPECT_EQ(grid.values(0, 1, 7), 2);
    EXPECT_EQ(grid.values(0, 1, 5), (0.02F + 1.0F) / 2);
}

TEST(Binner, DoesNotDependOnTheOrderOfEvents) {
    std::mt19937 rng{3};
    auto events = random_events(rng, kEpoch, 50'000, 3000);
    const VoxelGrid ordered = grid_of(event_window_of(events, kEpoch, 50'000), 5);
    for (int round = 0; round < 5; ++round) {
        std::shuffle(events.begin(), events.end(), rng);
        EXPECT_EQ(grid_of(event_window_of(events, kEpoch, 50'000), 5).values, ordered.values);
    }
}

TEST(Binner, DoesNotDependOnAbsoluteTime) {
    std::mt19937 rng{4};
    const auto events = random_events(rng, 0, 50'000, 3000);
    auto moved = events;
    for (Event& e : moved) e.t += SensorDuration{kEpoch};
    EXPECT_EQ(grid_of(event_window_of(moved, kEpoch, 50'000), 5).values,
              grid_of(event_window_of(events, 0, 50'000), 5).values);
}

TEST(Binner, SumsOfTheGridAreSumsOfTheEvents) {
    std::mt19937 rng{5};
    const auto events = random_events(rng, 0, 12'345, 4000);
    const VoxelGrid grid = grid_of(event_window_of(events, 0, 12'345), 7);
    double polarity = 0, count = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int b = 0; b < 7; ++b) {
                polarity += grid.values(y, x, 4 * b);
                count += grid.values(y, x, 4 * b + 3);
            }
    double expected = 0;
    for (const Event& e : events) expected += e.polarity == Polarity::on ? 1 : -1;
    EXPECT_EQ(polarity, expected);
    EXPECT_EQ(count, double(events.size()));
    EXPECT_EQ(grid.events, events.size());
}

TEST(Binner, EqualTimestampsHaveExactlyNoSpread) {
    for (const std::int64_t dt : {1, 3, 49'999, 50'000})
        for (const std::size_t n : {2U, 3U, 7U, 100'000U, 1'000'000U}) {
            const std::vector<Event> events(n, event(kEpoch + dt, 1, 1));
            const VoxelGrid grid = grid_of(event_window_of(events, kEpoch, 50'000), 5);
            for (int b = 0; b < 5; ++b)
                EXPECT_EQ(grid.values(1, 1, 4 * b + 2), 0) << dt << ' ' << n;
        }
}

TEST(Binner, AHotPixelOfTenMillionEventsNeitherOverflowsNorLosesItsSpread) {
    for (const std::int64_t width_us : {3'000LL, 50'000LL, 524'287LL, 3'600'000'000LL}) {
        std::vector<Event> events(10'000'000);  // half at the very begin, half at the very end
        for (std::size_t i = 0; i < events.size(); ++i)
            events[i] = event(i < events.size() / 2 ? 1 : width_us, 0, 0, false);
        const VoxelGrid grid = grid_of(event_window_of(events, 0, width_us), 1);
        EXPECT_EQ(grid.values(0, 0, 0), -1e7F);
        const float begin = 1 / float(width_us);
        EXPECT_NEAR(grid.values(0, 0, 1), (1 + begin) / 2, 2e-5F);
        EXPECT_NEAR(grid.values(0, 0, 2), (1 - begin) / 2, 2e-5F);
        EXPECT_EQ(grid.values(0, 0, 3), 1e7F);
    }
}

TEST(Binner, ABusyPixelKeepsItsSpreadAcrossAWideBin) {
    // As many as the sums of squares times their number still fit, and just more.
    for (const int n : {60'000, 65'535, 65'536}) {
        std::vector<Event> events(static_cast<std::size_t>(n));
        for (int i = 0; i < n; ++i)
            events[std::size_t(i)] = event(1 + std::int64_t(i) * 500'000 / n, 0, 0);
        const EventWindow window = event_window_of(events, 0, 500'000);
        const VoxelGrid grid = grid_of(window, 1);
        EXPECT_NEAR(grid.values(0, 0, 2), oracle(window, 1, 1, 1)(0, 0, 2), 1e-6F) << n;
    }
}

TEST(Binner, CountsFramesSinceTheLastEvent) {
    Binner binner(2, kHeight, kWidth);
    VoxelGrid grid = binner.make_output();
    const std::vector<Event> one{event(10, 2, 3)};
    const auto age_after = [&](bool with_event) {
        binner.process(event_window_of(with_event ? one : std::vector<Event>{}, 0, 100), grid);
        return grid.values(3, 2, 8);
    };
    EXPECT_EQ(age_after(false), 1) << "a pixel that never had an event is as old as can be";
    EXPECT_EQ(age_after(true), 0);
    for (int frames = 1; frames <= 8; ++frames) EXPECT_EQ(age_after(false), float(frames) / 8);
    EXPECT_EQ(age_after(false), 1);
    EXPECT_EQ(age_after(true), 0);
    binner.reset();
    EXPECT_EQ(age_after(false), 1);
}

TEST(Binner, SaysWhichPixelsHaveEvents) {
    std::mt19937 rng{3};
    Binner binner{3, kHeight, kWidth};
    VoxelGrid grid = binner.make_output();
    for (const std::size_t n : {std::size_t{4}, std::size_t{0}, std::size_t{20}, std::size_t{1}}) {
        const auto events = random_events(rng, kEpoch, 50'000, n);
        binner.process(event_window_of(events, kEpoch, 50'000), grid);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const bool any =
                    grid.values(y, x, 3) + grid.values(y, x, 7) + grid.values(y, x, 11) > 0;
                EXPECT_EQ(grid.touched(y, x), std::uint8_t(any)) << n << " events";
            }
    }
}

TEST(Binner, LeavesNothingOfTheFrameBefore) {
    std::mt19937 rng{6};
    Binner used(5, kHeight, kWidth);
    VoxelGrid grid = used.make_output();
    for (int round = 0; round < 10; ++round) {
        const auto events = random_events(rng, 0, 1000, 100);
        used.reset();
        used.process(event_window_of(events, 0, 1000), grid);
        EXPECT_EQ(grid.values, grid_of(event_window_of(events, 0, 1000), 5).values);
    }
}

// Of silence, a few pixels and all of them, over as many windows as ages are told apart and more.
TEST(Binner, AGridThatIsUsedAgainIsAsAFreshOne) {
    constexpr int kRows = 13, kColumns = 31;  // no whole number of blocks
    std::mt19937 rng{9};
    Binner used{2, kRows, kColumns}, fresh{2, kRows, kColumns};
    std::vector<VoxelGrid> grids(3, used.make_output());
    const std::size_t counts[] = {0, 0, 1, 5, 40, 2000};
    for (int round = 0; round < 300; ++round) {
        std::vector<Event> events(counts[rng() % std::size(counts)]);
        for (Event& each : events)
            each = event(1 + std::int64_t(rng() % 1000), int(rng() % kColumns), int(rng() % kRows));
        const EventWindow window = event_window_of(events, 0, 1000);
        VoxelGrid& grid = grids[rng() % grids.size()];
        used.process(window, grid);
        VoxelGrid expected = fresh.make_output();
        fresh.process(window, expected);
        ASSERT_EQ(grid.values, expected.values) << round;
        ASSERT_EQ(grid.touched, expected.touched) << round;
        if (rng() % 20 != 0) continue;
        used.reset();
        fresh.reset();
    }
}

TEST(Binner, WhatItIsToldIsOlderThanCountsIsAsOldAsCounts) {
    Binner binner{1, 1, 3};
    binner.restore({0, 9, 255});
    VoxelGrid grid = binner.make_output();
    binner.process(event_window_of({}, 0, 100), grid);
    EXPECT_EQ(grid.values(0, 0, 4), 1.0F / 8);
    EXPECT_EQ(grid.values(0, 1, 4), 1);
    EXPECT_EQ(grid.values(0, 2, 4), 1);
}

TEST(Binner, LeavesOutWhatIsOutsideTheSensorOrTheWindow) {
    const std::vector<Event> events{event(0, 0, 0), event(50, kWidth, 0), event(50, 0, kHeight),
                                    event(101, 0, 0)};
    const VoxelGrid grid = grid_of(event_window_of(events, 0, 100), 2);
    for (const auto& values : {grid.values})
        for (std::size_t i = 0; i < values.values().size(); ++i)
            EXPECT_EQ(values.values()[i], i % 9 == 8 ? 1.0F : 0.0F);
}

TEST(Binner, AGridTellsWhatItsWindowTells) {
    EventWindow told = event_window_of({}, 100, 50);
    told.gap_before = true;
    told.arrived = HostTime{} + std::chrono::seconds{7};
    const VoxelGrid first = grid_of(told, 2);
    EXPECT_TRUE(first.gap_before && !first.reset_before);
    EXPECT_EQ(first.arrived, told.arrived);
    EXPECT_EQ(first.window.end, told.window.end);
    told.reset_before = true;
    told.gap_before = false;
    const VoxelGrid second = grid_of(told, 2);
    EXPECT_TRUE(second.reset_before && !second.gap_before);
}

TEST(Binner, AnEmptyWindowOfNoWidthIsAnEmptyGrid) {
    const VoxelGrid grid = grid_of(event_window_of({}, 100, 0), 2);
    EXPECT_EQ(grid.values(0, 0, 3), 0);
}

TEST(Binner, RefusesShapesThatCannotBe) {
    EXPECT_THROW(Binner(0, 1, 1), Error);
    EXPECT_THROW(Binner(1, 0, 1), Error);
    EXPECT_THROW(Binner(1, 1, -1), Error);
}

TEST(Binner, TheOracleSeesAWrongBinEdge) {
    const std::vector<Event> events{event(50, 0, 0)};
    EventWindow event_window = event_window_of(events, 0, 100);
    EXPECT_EQ(oracle(event_window, 2, 1, 1)(0, 0, 3), 1);
    event_window.window.begin = from_us(-1);
    EXPECT_EQ(oracle(event_window, 2, 1, 1)(0, 0, 3), 0);
}

}  // namespace
}  // namespace eventide
