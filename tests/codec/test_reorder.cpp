// Events a little out of order come out in order; what is beyond that comes as it came.
#include "src/codec/reorder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace eventide {
namespace {

using Times = std::vector<std::int64_t>;

/// What comes out; drained after every `n` events.
Times through(std::int64_t window_us, const Times& in, std::size_t n = 1) {
    Reorder reorder{SensorDuration{window_us}};
    Times out;
    const auto take = [&](const Event& event) { out.push_back(to_us(event.t)); };
    for (std::size_t i = 0; i < in.size(); ++i) {
        reorder.push({from_us(in[i]), 0, 0, Polarity::on}, take);
        if (i % n == n - 1 && !reorder.is_empty()) reorder.drain(take);
    }
    reorder.flush(take);
    return out;
}

TEST(Reorder, SortsWithinItsWindow) {
    EXPECT_EQ(through(100, {10, 50, 20, 120, 60, 119, 300}),
              (Times{10, 20, 50, 60, 119, 120, 300}));
    EXPECT_EQ(through(0, {3, 1, 2}), (Times{3, 1, 2}));
}

TEST(Reorder, EventsOfOneTimeStayInTheirOrder) {
    Reorder reorder{SensorDuration{100}};
    std::vector<int> xs;
    const auto take = [&](const Event& event) { xs.push_back(event.x); };
    for (const auto& [t, x] : {std::pair{5, 0}, {7, 1}, {5, 2}, {7, 3}, {5, 4}})
        reorder.push({from_us(t), std::uint16_t(x), 0, Polarity::on}, take);
    reorder.flush(take);
    EXPECT_EQ(xs, (std::vector{0, 2, 4, 1, 3}));
}

/// Where each late event moved those behind it, this took longer than a test may.
TEST(Reorder, AMillionEventsInAnyOrderAreSorted) {
    constexpr std::size_t kEvents = 1'000'000;
    static_assert(kEvents < Reorder::kMaxHeld);
    std::mt19937 random(1);
    std::vector<Event> events(kEvents), sorted;
    for (std::size_t i = 0; i < kEvents; ++i)
        events[i] = {from_us(std::int64_t(random() % 100'000)), std::uint16_t(i & 0x3FFF),
                     std::uint16_t(i >> 14), Polarity::on};
    Reorder reorder{SensorDuration{100'000}};
    const auto take = [&](const Event& event) { sorted.push_back(event); };
    for (const Event& event : events) reorder.push(event, take);
    reorder.flush(take);
    std::ranges::stable_sort(events, {}, &Event::t);
    EXPECT_TRUE(sorted == events);
}

TEST(Reorder, WhatIsTooLateComesAtOnceAndChangesNothingElse) {
    EXPECT_EQ(through(100, {1000, 1010, 5, 1005}), (Times{5, 1000, 1005, 1010}));
}

TEST(Reorder, OneWrongTimeKeepsNothingFromBeingSorted) {
    const std::int64_t wrong = 9'000'000'000'000;
    EXPECT_EQ(through(100, {10, 20, wrong, 40, 30, 60, 50}),
              (Times{10, 20, wrong, 30, 40, 50, 60}));
    EXPECT_EQ(through(100, {INT64_MIN, INT64_MAX, INT64_MIN, 3, 2}),
              (Times{INT64_MIN, INT64_MAX, INT64_MIN, 2, 3}));
}

TEST(Reorder, HowOftenItIsDrainedChangesNothing) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        std::mt19937 random(seed);
        Times in;
        for (std::int64_t t = 0; in.size() < 20'000; t += random() % 20)
            in.push_back(random() % 500 == 0 ? t - 5000 : t - std::int64_t(random() % 1200));
        const Times each = through(1000, in);
        for (const std::size_t n : {std::size_t{7}, std::size_t{3000}, in.size() + 1})
            EXPECT_EQ(through(1000, in, n), each) << seed << " " << n;
    }
}

TEST(Reorder, HoldsSoMuchAndNoMore) {
    Reorder reorder{SensorDuration{100}};
    std::size_t taken = 0;
    const auto take = [&](const Event&) { ++taken; };
    for (std::size_t i = 0; i < Reorder::kMaxHeld + 1000; ++i)
        reorder.push({from_us(5), 0, 0, Polarity::on}, take);
    EXPECT_EQ(taken, 1000U);
}

}  // namespace
}  // namespace eventide
