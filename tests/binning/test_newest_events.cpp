#include "src/binning/newest_events.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

namespace eventide {
namespace {

constexpr int kWidth = 7, kHeight = 5;

Event at(std::int64_t us, int x, int y, Polarity polarity = Polarity::on) {
    return {from_us(us), std::uint16_t(x), std::uint16_t(y), polarity};
}

/// The same, as one would say it.
NewestEvents::Around counted(const std::vector<Event>& before, const Event& event,
                             SensorDuration fired_within, SensorDuration alike_within) {
    NewestEvents::Around found;
    for (int y = event.y - 1; y <= event.y + 1; ++y)
        for (int x = event.x - 1; x <= event.x + 1; ++x) {
            const Event* newest = nullptr;
            for (const Event& one : before)
                if (one.x == x && one.y == y && (x != event.x || y != event.y)) newest = &one;
            if (newest == nullptr || newest->t > event.t) continue;
            const SensorDuration age = event.t - newest->t;
            found.fired += age <= fired_within ? 1 : 0;
            found.alike += age <= alike_within && newest->polarity == event.polarity ? 1 : 0;
        }
    return found;
}

/// Random events, of which each pause is up to so long; of the last, the newest 200 are compared.
void expect_as_counted(std::int64_t begin_us, std::int64_t longest_pause_us, int n) {
    std::mt19937_64 random{11};
    NewestEvents newest{kWidth, kHeight};
    newest.forget(from_us(begin_us));
    std::vector<Event> before;
    for (std::int64_t i = 0, us = begin_us; i < n; ++i) {
        us += std::int64_t(random() % std::uint64_t(longest_pause_us + 1));
        const Event event = at(us, int(random() % kWidth), int(random() % kHeight),
                               random() % 2 == 0 ? Polarity::on : Polarity::off);
        const SensorDuration fired{std::int64_t(random() % 10'000'001)}, alike = fired * 2 / 3;
        newest.advance(event.t);
        const auto found = newest.around(event, fired, alike);
        const auto expected = counted(before, event, fired, alike);
        ASSERT_EQ(found.fired, expected.fired) << "event " << i << " at " << us << " us";
        ASSERT_EQ(found.alike, expected.alike) << "event " << i << " at " << us << " us";
        newest.set(event);
        before.push_back(event);
        if (before.size() > 400) before.erase(before.begin(), before.begin() + 200);
    }
}

TEST(NewestEvents, CountsTheNeighboursThatFired) {
    expect_as_counted(0, 1'000'000, 3000);
}

TEST(NewestEvents, ForDaysAndFromAnyTimeOn) {
    expect_as_counted(1'700'000'000'000'000, 0, 500);
    for (const std::int64_t begin :
         {std::int64_t{0}, -(std::int64_t{1} << 40), std::int64_t{1} << 61})
        for (const std::int64_t pause : {2'000'000, 60'000'000})
            expect_as_counted(begin + (std::int64_t{1} << 31) - 50'000'000, pause, 5000);
}

TEST(NewestEvents, AnEventAsOldAsItMayBeCountsAndNoOlderOne) {
    for (const auto& [us, fired, alike] :
         {std::tuple{1000, 1, 1}, {1001, 1, 0}, {1500, 1, 0}, {1501, 0, 0}}) {
        NewestEvents newest{kWidth, kHeight};
        newest.forget(from_us(0));
        newest.set(at(0, 2, 2));
        const auto found = newest.around(at(us, 3, 3), SensorDuration{1500}, SensorDuration{1000});
        EXPECT_EQ(found.fired, fired) << us;
        EXPECT_EQ(found.alike, alike) << us;
    }
}

/// A pause after which the microseconds, modulo 2^31, are again what they were.
TEST(NewestEvents, DoesNotTakeAnEventOfHoursAgoForANewOne) {
    for (const std::int64_t pause_us :
         {std::int64_t{1} << 31, std::int64_t{1} << 32, (std::int64_t{1} << 31) - 5,
          3 * (std::int64_t{1} << 31) + 5}) {
        NewestEvents newest{kWidth, kHeight};
        newest.forget(from_us(100));
        newest.set(at(100, 2, 2));
        newest.advance(from_us(100 + pause_us));
        EXPECT_EQ(
            newest.around(at(100 + pause_us, 3, 3), NewestEvents::kLongest, NewestEvents::kLongest)
                .fired,
            0)
            << pause_us;
    }
}

TEST(NewestEvents, WhatIsLaterThanAnEventHasNotFired) {
    NewestEvents newest{kWidth, kHeight};
    newest.forget(from_us(5000));
    newest.set(at(5000, 2, 2));
    const auto around = [&](int us) {
        return newest.around(at(us, 3, 3), SensorDuration{100}, SensorDuration{100}).fired;
    };
    EXPECT_EQ(around(4999), 0);
    EXPECT_EQ(around(5000), 1);
}

TEST(NewestEvents, AreKnownToTheOneTheyAreGivenTo) {
    std::mt19937 random{5};
    NewestEvents first{kWidth, kHeight}, second{kWidth, kHeight};
    first.forget(from_us(0));
    for (int i = 0; i < 40; ++i)
        first.set(at(500'000 * i, int(random() % kWidth), int(random() % kHeight),
                     random() % 2 == 0 ? Polarity::on : Polarity::off));
    const SensorTime now = from_us(20'000'000);
    second.restore(now, first.times(now), first.polarities(now));
    EXPECT_EQ(second.times(now), first.times(now));
    EXPECT_EQ(second.polarities(now), first.polarities(now));
    EXPECT_TRUE(std::ranges::any_of(
        first.times(now), [&](SensorTime t) { return t >= now - NewestEvents::kLongest; }));
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (const Polarity polarity : {Polarity::on, Polarity::off}) {
                const Event event = at(20'000'000, x, y, polarity);
                const auto a =
                    first.around(event, SensorDuration{9'000'000}, SensorDuration{4'000'000});
                const auto b =
                    second.around(event, SensorDuration{9'000'000}, SensorDuration{4'000'000});
                EXPECT_EQ(a.fired, b.fired);
                EXPECT_EQ(a.alike, b.alike);
            }
}

/// The clock went back a little: what came before it did is in the future, and counts once that is
/// past.
TEST(NewestEvents, OfAMomentAheadAreGivenOnToo) {
    NewestEvents first{kWidth, kHeight}, second{kWidth, kHeight};
    first.forget(from_us(0));
    first.set(at(5'240'000, 2, 2));
    const SensorTime now = from_us(5'000'000);
    second.restore(now, first.times(now), first.polarities(now));
    for (const NewestEvents* newest : {&first, &second})
        for (const auto& [us, fired] : {std::pair{5'000'001, 0}, {5'239'999, 0}, {5'240'001, 1}})
            EXPECT_EQ(newest->around(at(us, 3, 3), SensorDuration{100}, SensorDuration{100}).fired,
                      fired)
                << us;
}

}  // namespace
}  // namespace eventide
