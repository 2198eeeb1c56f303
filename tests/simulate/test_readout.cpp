// The way from the pixels to the bus: delay, order, speed and losses.
#include "src/simulate/sensor/readout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

/// One event every `every_us`, in steps of 1 ms, given backwards within each step.
std::vector<Event> read_out(Readout& readout, int milliseconds, int every_us) {
    std::vector<Event> out, step;
    std::int64_t number = 0;
    for (int ms = 0; ms < milliseconds; ++ms) {
        step.clear();
        for (int us = every_us; us <= 1000; us += every_us)
            step.push_back({from_us(ms * 1000 + us), std::uint16_t(number % 60000),
                            std::uint16_t(number++ / 60000), Polarity::on});
        std::ranges::reverse(step);
        readout.take(from_us(ms * 1000), from_us(ms * 1000 + 1000), step, out);
    }
    return out;
}

std::int64_t number_of(const Event& e) {
    return std::int64_t(e.y) * 60000 + e.x;
}

TEST(Readout, SortsAndKeepsEverythingWhenEveryEffectIsOff) {
    Readout readout{SensorTraits{}, 1000, Random{1}};
    const auto events = read_out(readout, 50, 10);
    ASSERT_EQ(events.size(), 5000u);
    for (std::size_t i = 0; i < events.size(); ++i) {
        EXPECT_EQ(to_us(events[i].t), std::int64_t(i + 1) * 10);
        EXPECT_EQ(number_of(events[i]), std::int64_t(i));
    }
}

TEST(Readout, DelaysByAnExponentialOfTheMeanAskedForAndStaysInOrder) {
    SensorTraits traits;
    traits.jitter_s = .0004;
    Readout readout{traits, 1000, Random{2}};
    const auto events = read_out(readout, 500, 10);
    EXPECT_TRUE(std::ranges::is_sorted(events, {}, &Event::t));
    EXPECT_GT(events.size(), 49500u);
    const auto step_of = [](const Event& e) { return number_of(e) / 100; };
    for (std::size_t i = 1; i < events.size(); ++i)
        EXPECT_TRUE(events[i].t != events[i - 1].t || step_of(events[i - 1]) <= step_of(events[i]))
            << "of one microsecond those that were given first come first";
    double mean = 0, square = 0;
    for (const Event& e : events) {
        const double delay = double(to_us(e.t) - (number_of(e) + 1) * 10);
        EXPECT_GE(delay, 0);
        mean += delay / double(events.size());
        square += delay * delay / double(events.size());
    }
    EXPECT_NEAR(mean, 400, 8);
    EXPECT_NEAR(std::sqrt(square - mean * mean), 400,
                12);  // an exponential's deviation is its mean
}

TEST(Readout, LosesTheShareAskedFor) {
    SensorTraits traits;
    traits.dropped = .1;
    Readout readout{traits, 1000, Random{3}};
    const auto events = read_out(readout, 500, 10);
    EXPECT_NEAR(double(events.size()), 45000, 300);
    EXPECT_EQ(events.size() + readout.dropped(), 50000u);
}

TEST(Readout, CarriesNoMoreThanTheBusAllowsAndDropsWhatWouldWaitTooLong) {
    SensorTraits traits;
    traits.arbiter_hz_per_pixel = 500;
    traits.arbiter_wait_s = .002;
    Readout readout{traits, 100, Random{4}};  // 50,000 events/s; twice as many come
    const auto events = read_out(readout, 100, 10);
    EXPECT_TRUE(std::ranges::is_sorted(events, {}, &Event::t));
    for (std::size_t i = 1; i < events.size(); ++i)
        EXPECT_GE(to_us(events[i].t) - to_us(events[i - 1].t), 20);
    for (const Event& e : events) EXPECT_LE(to_us(e.t) - (number_of(e) + 1) * 10, 2000);
    EXPECT_NEAR(double(events.size()), 5000, 120);
    EXPECT_EQ(events.size() + readout.dropped(), 10000u);
}

TEST(Readout, ABurstWaitsForTheBusAsLongAsItMay) {
    SensorTraits traits;
    traits.arbiter_hz_per_pixel = 500;
    traits.arbiter_wait_s = .002;
    Readout readout{traits, 100, Random{4}};  // 20 us for each event
    std::vector<Event> burst(300, Event{from_us(7), 0, 0, Polarity::on}), out;
    readout.take(from_us(0), from_us(1000), burst, out);
    ASSERT_EQ(out.size(), 101u);
    for (std::size_t i = 0; i < out.size(); ++i)
        EXPECT_EQ(to_us(out[i].t), 7 + 20 * std::int64_t(i));
    EXPECT_EQ(readout.dropped(), 199u);
    std::vector<Event> later{{from_us(5000), 0, 0, Polarity::on}};
    readout.take(from_us(1000), from_us(6000), later, out);
    EXPECT_EQ(to_us(out.back().t), 5000) << "the bus has been free for long";
}

TEST(Readout, LetsASlowStreamPassTheBusUnchanged) {
    SensorTraits traits;
    traits.arbiter_hz_per_pixel = 500;
    traits.arbiter_wait_s = .002;
    Readout readout{traits, 1000, Random{4}};
    const auto events = read_out(readout, 20, 10);
    ASSERT_EQ(events.size(), 2000u);
    for (const Event& e : events) EXPECT_EQ(to_us(e.t), (number_of(e) + 1) * 10);
}

}  // namespace
}  // namespace eventide
