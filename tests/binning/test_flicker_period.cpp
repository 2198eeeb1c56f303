// The period of a lamp's flicker is found; motion, noise and silence have none.
#include "src/binning/flicker_period.h"

#include "src/core/error.h"
#include "tests/support/flickering_light.h"

#include <gtest/gtest.h>

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

TEST(FlickerPeriod, IsFoundWhereThingsMoveToo) {
    const auto moving = bar_events(32, 24, .3, 1500);
    EXPECT_NEAR(period_of(merged(lamp_events({.share = .3}), moving)), 3333, 70);
}

TEST(FlickerPeriod, IsNoneWhereThingsOnlyMove) {
    for (const double speed : {300., 1000., 3000.})
        EXPECT_EQ(period_of(bar_events(32, 24, .5, speed)), 0) << speed << " px/s";
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

TEST(FlickerPeriod, RefusesTheStateOfAnotherSensorAndPeriodsThatAreNone) {
    FlickerPeriod period{32, 24}, larger{33, 24};
    EXPECT_THROW(larger.restore(period.state()), Error);
    FlickerPeriod::State state = period.state();
    for (const double us : {-1., 1., 1e9, std::nan("")}) {
        state.period_us = us;
        EXPECT_THROW(period.restore(state), Error) << us;
    }
    EXPECT_EQ(period.us(), 0);
}

}  // namespace
}  // namespace eventide::test
