// What a lamp's flicker adds is left out, and nothing else; whatever the calls, in order of time.
#include "src/binning/flicker_pairs.h"

#include "src/core/error.h"
#include "tests/support/flickering_light.h"

#include <gtest/gtest.h>

#include <random>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

using Events = std::vector<Event>;

constexpr int kWidth = 32, kHeight = 24;

Events left_of(Events events, SensorDuration longest = {}) {
    FlickerPairs pairs{kWidth, kHeight, longest};
    pairs.process(events);
    pairs.flush(events);
    return events;
}

std::size_t after(const Events& events, std::int64_t us) {
    return std::size_t(
        std::ranges::count_if(events, [&](const Event& e) { return to_us(e.t) > us; }));
}

/// Sum of polarities of each pixel.
std::vector<int> sums(const Events& events) {
    std::vector<int> sums(kWidth * kHeight);
    for (const Event& e : events)
        sums[std::size_t(e.y * kWidth + e.x)] += e.polarity == Polarity::on ? 1 : -1;
    return sums;
}

TEST(FlickerPairs, OfALampAreLeftOutOnceItsPeriodIsKnown) {
    for (const double hz : {100., 300.}) {
        const Events events = lamp_events({.hz = hz, .spread_us = .05e6 / hz});
        const Events left = left_of(events);
        EXPECT_LT(after(left, 150'000), after(events, 150'000) / 15) << hz << " Hz";
        EXPECT_EQ(sums(left), sums(events)) << "nothing is lost of what changed for longer";
    }
}

TEST(FlickerPairs, LeaveMotionWhereItIs) {
    const Events lamp = lamp_events({.share = .3}), bar = bar_events(kWidth, kHeight, .3, 1500);
    const Events left = left_of(merged(lamp, bar));
    EXPECT_GT(after(left, 150'000), after(bar, 150'000) * 95 / 100);
    EXPECT_LT(after(left, 150'000), after(bar, 150'000) + after(lamp, 150'000) / 10);
    EXPECT_EQ(sums(left), sums(merged(lamp, bar)));
}

TEST(FlickerPairs, ThatAreFartherApartAreLeftOutByThoseThatWaitLonger) {
    // A pixel that sees the lamp brighten and darken only two cycles later.
    Events events = lamp_events({});
    const std::int64_t us = 200'000;
    const auto lit = [&](std::int64_t t, Polarity p) { return Event{from_us(t), 3, 2, p}; };
    std::erase_if(events, [](const Event& e) { return e.x == 3 && e.y == 2; });
    events = merged(events, {lit(us, Polarity::on), lit(us + 8'333, Polarity::off)});
    const auto stay = [&](const Events& left) {
        return std::ranges::count_if(left, [](const Event& e) { return e.x == 3 && e.y == 2; });
    };
    EXPECT_EQ(stay(left_of(events)), 2);
    EXPECT_EQ(stay(left_of(events, SensorDuration{16'000})), 0);
}

/// How many events of one pixel, `us` after it fired first, stay in the light of a lamp of 100 Hz.
std::size_t left_of_pixel(const std::vector<std::pair<std::int64_t, Polarity>>& fired,
                          SensorDuration longest) {
    Events events = lamp_events({.hz = 100, .spread_us = 500});
    const auto is_its = [](const Event& e) { return e.x == 3 && e.y == 2; };
    std::erase_if(events, is_its);
    Events own;
    for (const auto& [us, polarity] : fired) own.push_back({from_us(230'000 + us), 3, 2, polarity});
    return std::size_t(std::ranges::count_if(left_of(merged(events, own), longest), is_its));
}

TEST(FlickerPairs, AreAQuarterOfAPeriodFromHalvesAtMost) {
    constexpr Polarity kOn = Polarity::on, kOff = Polarity::off;
    constexpr SensorDuration kLong{16'000};
    for (const auto& [us, stay] :
         {std::pair{1'500, 2U}, {3'500, 0U}, {6'500, 0U}, {8'500, 2U}, {13'500, 0U}})
        EXPECT_EQ(left_of_pixel({{0, kOn}, {us, kOff}}, kLong), stay) << us;
    EXPECT_EQ(left_of_pixel({{0, kOn}, {5'000, kOff}}, SensorDuration{5'000}), 0U) << "so long";
    EXPECT_EQ(left_of_pixel({{0, kOn}, {5'000, kOff}}, SensorDuration{4'999}), 2U);
    EXPECT_EQ(left_of_pixel({{0, kOn}, {5'000, kOn}}, kLong), 2U) << "no pair";
    EXPECT_EQ(left_of_pixel({{0, kOn}, {300, kOn}, {5'000, kOff}, {5'300, kOff}}, kLong), 0U)
        << "one within the other";
}

TEST(FlickerPairs, WaitForThreeQuartersOfAPeriodWhereNobodySaysHowLong) {
    FlickerPairs pairs{kWidth, kHeight, {}};
    Events events = lamp_events({.hz = 100, .spread_us = 500});
    pairs.process(events);
    EXPECT_NEAR(pairs.period_us(), 10'000, 200);
    EXPECT_EQ(pairs.known_until(from_us(500'000)),
              from_us(500'000 - std::int64_t(.75 * pairs.period_us())));
}

/// Bars go on moving.
TEST(FlickerPairs, ComeOutWhenTheLampIsOut) {
    Events events = merged(lamp_events({.seconds = .5}), bar_events(kWidth, kHeight, 2.5, 1500));
    FlickerPairs pairs{kWidth, kHeight, SensorDuration{16'000}};
    Events left;
    for (const Event& event : events) {
        Events one{event};
        pairs.process(one);
        left.insert(left.end(), one.begin(), one.end());
    }
    EXPECT_EQ(pairs.period_us(), 0);
    EXPECT_EQ(pairs.held(), 0U);
    EXPECT_TRUE(std::ranges::is_sorted(left, {}, &Event::t));
    EXPECT_EQ(left.size() + pairs.left_out(), events.size());
}

TEST(FlickerPairs, AreNotLookedForWhereNothingFlickers) {
    const Events events = bar_events(kWidth, kHeight, .3, 1000);
    FlickerPairs pairs{kWidth, kHeight, SensorDuration{16'000}};
    Events left = events;
    pairs.process(left);
    EXPECT_EQ(left, events);
    EXPECT_EQ(pairs.held(), 0U);
    EXPECT_EQ(pairs.known_until(left.back().t), left.back().t) << "nothing is later than it came";
}

TEST(FlickerPairs, AreTheSameHoweverTheStreamIsSplitAndComeOutInOrder) {
    const Events events = merged(lamp_events({}), bar_events(kWidth, kHeight, .3, 1500));
    const Events expected = left_of(events, SensorDuration{7'000});
    EXPECT_TRUE(std::ranges::is_sorted(expected, {}, &Event::t));
    std::mt19937 random{3};
    for (int trial = 0; trial < 5; ++trial) {
        FlickerPairs pairs{kWidth, kHeight, SensorDuration{7'000}};
        Events left;
        SensorTime promised = SensorTime::min();
        for (std::size_t at = 0; at < events.size();) {
            const std::size_t n = std::min<std::size_t>(1 + random() % 900, events.size() - at);
            Events part(events.begin() + std::ptrdiff_t(at),
                        events.begin() + std::ptrdiff_t(at + n));
            at += n;
            const SensorTime now = part.back().t;
            pairs.process(part);
            if (random() % 3 == 0) pairs.release(now, part);
            for (const Event& event : part) EXPECT_GE(event.t, promised);
            left.insert(left.end(), part.begin(), part.end());
            promised = pairs.known_until(now);
        }
        pairs.flush(left);
        EXPECT_EQ(left, expected);
    }
}

/// A call may see a lamp go out and another one come on.
TEST(FlickerPairs, AreTheSameHoweverAStreamWhoseFlickerPausesIsSplit) {
    const auto later = [](Events events, std::int64_t us) {
        for (Event& event : events) event.t += SensorDuration{us};
        return events;
    };
    const Events lamp = lamp_events({});
    const Events events = merged(merged(lamp, later(lamp, 800'000)),
                                 later(bar_events(kWidth, kHeight, .4, 1500), 350'000));
    const Events expected = left_of(events);
    ASSERT_LT(after(expected, 1'000'000), after(events, 1'000'000) / 2);
    for (const std::size_t part_of : {1U, 7U, 100U, 5'000U}) {
        FlickerPairs pairs{kWidth, kHeight, {}};
        Events left;
        for (std::size_t at = 0; at < events.size(); at += part_of) {
            Events part(events.begin() + std::ptrdiff_t(at),
                        events.begin() + std::ptrdiff_t(std::min(at + part_of, events.size())));
            pairs.process(part);
            left.insert(left.end(), part.begin(), part.end());
        }
        pairs.flush(left);
        EXPECT_EQ(left, expected) << part_of;
    }
}

TEST(FlickerPairs, AreTheSameWhereverTheirNumbersBeginAnew) {
    const Events events = merged(lamp_events({}), bar_events(kWidth, kHeight, .3, 1500));
    const Events expected = left_of(events, SensorDuration{16'000});
    for (const std::uint32_t renumber_at : {2U, 100U, 5'000U}) {
        FlickerPairs pairs{kWidth, kHeight, SensorDuration{16'000}, renumber_at};
        Events left = events;
        pairs.process(left);
        pairs.flush(left);
        EXPECT_EQ(left, expected) << renumber_at;
    }
}

TEST(FlickerPairs, ComeOutAsTimeGoesOnWithoutEvents) {
    Events events = lamp_events({});
    FlickerPairs pairs{kWidth, kHeight, SensorDuration{16'000}};
    pairs.process(events);
    const std::size_t held = pairs.held();
    ASSERT_GT(held, 0U);
    Events later;
    pairs.release(from_us(400'000), later);
    EXPECT_EQ(later.size(), held);
    EXPECT_EQ(pairs.held(), 0U);
}

TEST(FlickerPairs, GoOnFromAState) {
    const Events events = merged(lamp_events({}), bar_events(kWidth, kHeight, .3, 1500));
    const auto middle = events.begin() + std::ptrdiff_t(2 * events.size() / 3);
    Events first(events.begin(), middle), rest(middle, events.end()), again = rest;
    FlickerPairs pairs{kWidth, kHeight, {}}, resumed{kWidth, kHeight, {}};
    pairs.process(first);
    ASSERT_GT(pairs.held(), 0U);
    resumed.restore(pairs.state());
    EXPECT_EQ(resumed.state(), pairs.state());
    pairs.process(rest);
    pairs.flush(rest);
    resumed.process(again);
    resumed.flush(again);
    EXPECT_EQ(again, rest);
    FlickerPairs::State held = FlickerPairs{kWidth, kHeight, {}}.state();
    held.held = {events.front()};
    EXPECT_THROW(resumed.restore(held), Error) << "held although nothing flickers";
}

TEST(FlickerPairs, LetGoOfEverythingWhereTheClockGoesBack) {
    Events events = lamp_events({});
    const Events begun_anew = lamp_events({.seconds = .01});
    const std::size_t before = left_of(events).size();
    events.insert(events.end(), begun_anew.begin(), begun_anew.end());
    const Events left = left_of(events);
    ASSERT_GE(left.size(), before);
    EXPECT_TRUE(
        std::ranges::is_sorted(left.begin(), left.begin() + std::ptrdiff_t(before), {}, &Event::t));
    EXPECT_TRUE(
        std::ranges::is_sorted(left.begin() + std::ptrdiff_t(before), left.end(), {}, &Event::t));
}

TEST(FlickerPairs, WaitAsAUserSays) {
    EXPECT_EQ(parse_lamp_flicker("off", true), std::nullopt);
    EXPECT_EQ(parse_lamp_flicker("auto", false), SensorDuration{0});
    EXPECT_EQ(parse_lamp_flicker("auto", true), SensorDuration{16'000});
    EXPECT_EQ(parse_lamp_flicker("10ms", false), SensorDuration{10'000});
    for (const char* text : {"", "on", "10", "0ms", "-1ms", "101ms", "nan"})
        EXPECT_THROW(parse_lamp_flicker(text, false), Error) << text;
}

}  // namespace
}  // namespace eventide::test
