#include "src/binning/hot_pixels.h"

#include <gtest/gtest.h>

#include <utility>

namespace eventide {
namespace {

constexpr int kWidth = 20, kHeight = 15;

Event at(std::int64_t us, int x, int y) {
    return {from_us(us), std::uint16_t(x), std::uint16_t(y), Polarity::on};
}

/// Pixels that fire every 10 ms for 3 s; how many of them are hot at 20 Hz in half a second.
std::size_t hot_of(const std::vector<std::pair<int, int>>& pixels) {
    HotPixels hot{kWidth, kHeight, 20, SensorDuration{500'000}};
    for (int ms = 0; ms < 3000; ms += 10)
        for (const auto& [x, y] : pixels) hot.is_hot(at(1000 * ms, x, y));
    return hot.count();
}

TEST(HotPixels, AreThoseThatStandAlone) {
    EXPECT_EQ(hot_of({{7, 9}}), 1U);
    EXPECT_EQ(hot_of({{0, 0}, {19, 14}}), 2U);
    EXPECT_EQ(hot_of({{7, 9}, {8, 9}}), 2U) << "two side by side";
}

TEST(HotPixels, AreNotWhatTrembles) {
    EXPECT_EQ(hot_of({{7, 5}, {7, 6}, {7, 7}, {8, 8}, {9, 9}, {9, 10}}), 2U)
        << "a line of one pixel: its ends alone";
    EXPECT_EQ(hot_of({{0, 5}, {0, 6}, {0, 7}}), 2U) << "along the sensor's edges, too";
    EXPECT_EQ(hot_of({{19, 5}, {19, 6}, {19, 7}}), 2U);
    EXPECT_EQ(hot_of({{5, 0}, {6, 0}, {7, 0}}), 2U);
    EXPECT_EQ(hot_of({{5, 14}, {6, 14}, {7, 14}}), 2U);
}

TEST(HotPixels, AreTakenBackWhenTheyHaveCalmedDown) {
    HotPixels hot{kWidth, kHeight, 20, SensorDuration{500'000}};
    for (int ms = 0; ms < 1000; ms += 10) hot.is_hot(at(1000 * ms, 7, 9));
    EXPECT_TRUE(hot.is_hot(at(1'000'000, 7, 9)));
    EXPECT_FALSE(hot.is_hot(at(5'000'000, 7, 9)));
}

TEST(HotPixels, StayHotUntilTheyFireLessThanHalfAsOften) {
    // Hot at 20 Hz; then 12 Hz for a while, then 8 Hz: six and four in half a second.
    HotPixels hot{kWidth, kHeight, 20, SensorDuration{500'000}};
    int ms = 0;
    for (; ms < 1000; ms += 10) hot.is_hot(at(1000 * ms, 7, 9));
    for (; ms < 4000; ms += 83) hot.is_hot(at(1000 * ms, 7, 9));
    EXPECT_EQ(hot.count(), 1U) << "12 Hz";
    for (; ms < 6000; ms += 125) hot.is_hot(at(1000 * ms, 7, 9));
    EXPECT_EQ(hot.count(), 0U) << "8 Hz";
}

/// `n` events of a pixel in each half a second, and `beside` of two of its neighbours.
bool is_hot_by(int n, int beside, int first_n = 0) {
    HotPixels hot{kWidth, kHeight, 20, SensorDuration{500'000}};
    for (int interval = 0; interval < 2; ++interval)
        for (int i = 0; i < 50; ++i) {
            const std::int64_t us = 500'000 * interval + 10'000 * i;
            if (i < (interval == 0 && first_n > 0 ? first_n : n)) hot.is_hot(at(us, 7, 9));
            if (i < beside) hot.is_hot(at(us, 8, 9));
            if (i < beside) hot.is_hot(at(us, 6, 8));
        }
    return hot.is_hot(at(1'000'000, 7, 9));
}

TEST(HotPixels, FireSoOftenAtLeast) {
    EXPECT_TRUE(is_hot_by(10, 0)) << "20 Hz";
    EXPECT_FALSE(is_hot_by(9, 0));
    EXPECT_TRUE(is_hot_by(40, 10)) << "four times as often as two neighbours";
    EXPECT_FALSE(is_hot_by(40, 11));
    EXPECT_TRUE(is_hot_by(5, 0, 50)) << "half as often, once it is hot";
    EXPECT_FALSE(is_hot_by(4, 0, 50));
}

TEST(HotPixels, AreNoneAfterASilence) {
    HotPixels hot{kWidth, kHeight, 20, SensorDuration{500'000}};
    for (int ms = 0; ms < 1400; ms += 10) hot.is_hot(at(1000 * ms, 7, 9));
    EXPECT_FALSE(hot.is_hot(at(5'000'000, 7, 9))) << "in the interval before it did not fire";
    for (int ms = 5000; ms < 5600; ms += 10) hot.is_hot(at(1000 * ms, 7, 9));
    EXPECT_EQ(hot.count(), 1U) << "and again";
    for (int ms = 0; ms < 600; ms += 10) hot.is_hot(at(3'600'000'000 + 1000 * ms, 7, 9));
    EXPECT_EQ(hot.count(), 1U) << "also after an hour";
}

TEST(HotPixels, AreCountedFromWhereTheClockBeganAnew) {
    // 12 Hz: six events in half a second, each time the clock begins anew another five before.
    for (const int first_ms : {0, 3, 100}) {
        HotPixels hot{kWidth, kHeight, 20, SensorDuration{500'000}};
        for (int clock = 0; clock < 4; ++clock)
            for (int ms = first_ms * (3 - clock); ms < 420; ms += 83)
                hot.is_hot(at(1000 * ms, 7, 9));
        for (int ms = 420; ms < 1000; ms += 83) hot.is_hot(at(1000 * ms, 7, 9));
        EXPECT_EQ(hot.count(), 0U) << first_ms;
    }
}

TEST(HotPixels, AreKnownToTheOneTheyAreGivenTo) {
    HotPixels first{kWidth, kHeight, 20, SensorDuration{500'000}};
    HotPixels second{kWidth, kHeight, 20, SensorDuration{500'000}};
    second.is_hot(at(900'000'000, 3, 3));  // of another recording
    for (int ms = 0; ms < 1400; ms += 10) first.is_hot(at(1000 * ms, 7, 9));
    for (int ms = 1000; ms < 1400; ms += 10) first.is_hot(at(1000 * ms, 2, 2));
    second.restore(first.state());
    EXPECT_TRUE(second.state() == first.state());
    for (HotPixels* hot : {&first, &second}) {
        EXPECT_TRUE(hot->is_hot(at(1'400'000, 7, 9)));
        EXPECT_FALSE(hot->is_hot(at(1'410'000, 2, 2)));
        EXPECT_TRUE(hot->is_hot(at(1'500'000, 2, 2))) << "with what was counted before";
    }
}

TEST(HotPixels, AreForgottenByAReset) {
    HotPixels hot{kWidth, kHeight, 20, SensorDuration{500'000}};
    const HotPixels::State fresh = hot.state();
    for (int ms = 0; ms < 1200; ms += 10) hot.is_hot(at(1000 * ms, 7, 9));
    EXPECT_EQ(hot.count(), 1U);
    hot.reset();
    EXPECT_EQ(hot.count(), 0U);
    EXPECT_TRUE(hot.state() == fresh);
}

TEST(HotPixels, AreOfAnySensor) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {9, 1}}) {
        HotPixels hot{width, height, 20, SensorDuration{500'000}};
        for (int ms = 0; ms < 1000; ms += 10) hot.is_hot(at(1000 * ms, 0, 0));
        EXPECT_TRUE(hot.is_hot(at(1'000'000, width - 1, height - 1)) == (width * height == 1));
        EXPECT_EQ(hot.count(), 1U);
    }
}

}  // namespace
}  // namespace eventide
