// The period of a lamp's flicker is found; motion, noise and silence have none.
#include "src/binning/flicker_period.h"

#include "src/core/error.h"
#include "tests/support/flickering_light.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace eventide::test {
namespace {

double period_of(const std::vector<Event>& events) {
    FlickerPeriod period{32, 24};
    for (const Event& event : events) period.see(event);
    return period.us();
}

TEST(FlickerPeriod, IsThatOfTheLamp) {
    for (const double hz : {100., 120., 200., 300., 500., 700.})
        for (const double share : {.3, 1.}) {
            const double us =
                period_of(lamp_events({.hz = hz, .share = share, .spread_us = .05e6 / hz}));
            EXPECT_NEAR(us, 1e6 / hz, .015e6 / hz) << hz << " Hz, seen in " << share;
        }
}

/// Pixels that have not risen yet did not rise at the clock's zero.
TEST(FlickerPeriod, DoesNotHangOnWhereTheClockBegan) {
    const auto seen_from = [](std::int64_t begin_us) {
        std::vector<Event> events = lamp_events({.hz = 100, .share = .3, .spread_us = 500});
        const SensorTime first = events.front().t;
        FlickerPeriod period{32, 24};
        for (Event& event : events) {
            event.t = from_us(begin_us) + (event.t - first);
            if (event.t > from_us(begin_us + 40'000)) break;  // of the first block
            period.see(event);
        }
        return period.state().intervals;
    };
    const auto expected = seen_from(1'600'000'000'000'000);
    EXPECT_GT(std::accumulate(expected.begin(), expected.end(), 0U), 0U);
    for (const std::int64_t begin_us : {0L, 5'000L, 44'000L, 1'000'000L, 1L << 31})
        EXPECT_EQ(seen_from(begin_us), expected) << begin_us;
}

TEST(FlickerPeriod, IsFoundWhereThingsMoveToo) {
    const auto moving = bar_events(32, 24, .3, 1500);
    EXPECT_NEAR(period_of(merged(lamp_events({.share = .3}), moving)), 3333, 70);
}

TEST(FlickerPeriod, IsNoneWhereThingsOnlyMove) {
    for (const double speed : {300., 1000., 3000.})
        EXPECT_EQ(period_of(bar_events(32, 24, .5, speed)), 0) << speed << " px/s";
}

TEST(FlickerPeriod, IsNoneWhereAWheelTurns) {
    for (const int spokes : {2, 3, 5, 7})
        for (const double hz : {100., 170., 300., 600.})
            EXPECT_EQ(period_of(wheel_events({.spokes = spokes, .hz = hz})), 0)
                << spokes << " spokes, " << hz << " Hz";
}

TEST(FlickerPeriod, IsNoneWhereHalfAWheelIsSeen) {
    for (const int spokes : {2, 3, 4, 5})
        EXPECT_EQ(period_of(wheel_events({.y = 0, .spokes = spokes})), 0) << spokes << " spokes";
}

TEST(FlickerPeriod, IsThatOfTheLampWhereAWheelTurnsToo) {
    const auto wheel = wheel_events({.width = 16, .x = 8, .hz = 170});
    EXPECT_NEAR(period_of(merged(lamp_events({.share = .8}), wheel)), 3333, 70);
}

TEST(FlickerPeriod, IsFoundInTheLightOfLampsOnThreePhases) {
    std::vector<Event> events;
    for (const int phase : {0, 1, 2})
        for (Event event : lamp_events({.width = 10, .hz = 100, .spread_us = 300})) {
            event.x = std::uint16_t(event.x + 10 * phase);
            event.t += SensorDuration{phase * 10'000 / 3};
            events.push_back(event);
        }
    std::ranges::stable_sort(events, {}, &Event::t);
    EXPECT_NEAR(period_of(events), 10'000, 200);
}

TEST(FlickerPeriod, IsFoundWhereFewPixelsSeeIt) {
    const auto events = lamp_events({.width = 8, .height = 6, .hz = 120, .seconds = 2});
    EXPECT_NEAR(period_of(events), 8333, 150);
}

TEST(FlickerPeriod, IsFoundAfterAPauseToo) {
    std::vector<Event> events = lamp_events({.width = 2, .height = 2});
    for (Event event : lamp_events({})) {
        event.t += SensorDuration{3'000'000};
        events.push_back(event);
    }
    EXPECT_NEAR(period_of(events), 3333, 70);
}

TEST(FlickerPeriod, IsNoneInNoise) {
    std::mt19937 random{1};
    for (const double per_pixel_hz : {5., 50., 500.}) {
        std::exponential_distribution<double> pause{per_pixel_hz * 32 * 24 * 1e-6};
        std::vector<Event> events;
        for (double t = 1; t < 1e6; t += pause(random))
            events.push_back({from_us(std::int64_t(t)), std::uint16_t(random() % 32),
                              std::uint16_t(random() % 24),
                              random() % 2 == 0 ? Polarity::on : Polarity::off});
        EXPECT_EQ(period_of(events), 0) << per_pixel_hz << " Hz a pixel";
    }
}

TEST(FlickerPeriod, EndsWithTheFlicker) {
    FlickerPeriod period{32, 24};
    for (const Event& event : lamp_events({})) period.see(event);
    EXPECT_GT(period.us(), 0);
    for (Event event : bar_events(32, 24, 2, 1000)) {
        event.t += SensorDuration{400'000};
        period.see(event);
    }
    EXPECT_EQ(period.us(), 0);
}

TEST(FlickerPeriod, RefusesTheStateOfAnotherSensorAndWhatCannotBe) {
    FlickerPeriod period{32, 24}, larger{33, 24};
    EXPECT_THROW(larger.restore(period.state()), Error);
    FlickerPeriod::State state = period.state();
    for (const double us : {-1., 1., 1e9, std::nan("")}) {
        state.period_us = us;
        EXPECT_THROW(period.restore(state), Error) << us;
    }
    state.period_us = 0;
    state.block = from_us(5'000'000);
    for (const std::int64_t since : {0, 5'000'001}) {
        state.since = from_us(since);
        EXPECT_THROW(period.restore(state), Error) << since;
    }
    state.since = from_us(4'500'000);
    EXPECT_NO_THROW(period.restore(state));
    state.when.pop_back();
    EXPECT_THROW(period.restore(state), Error);
    EXPECT_EQ(period.us(), 0);
}

}  // namespace
}  // namespace eventide::test
