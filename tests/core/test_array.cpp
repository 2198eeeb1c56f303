// The containers everything flows in.
#include "src/core/array.h"
#include "src/core/damage.h"
#include "src/core/sensor_time.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace eventide {
namespace {

TEST(Array3, KeepsThePixelsNumbersTogether) {
    Array3<int> map{2, 3, 4};
    int n = 0;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x)
            for (int c = 0; c < 4; ++c) map(y, x, c) = n++;
    for (int i = 0; i < 24; ++i) EXPECT_EQ(map.values()[std::size_t(i)], i);
    EXPECT_EQ(map.pixel(1, 2)[3], 23);
}

TEST(Array2, StartsOnACacheLine) {
    for (int width : {1, 7, 64}) {
        const Array2<float> plane{3, width};
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(plane.values().data()) % 64, 0U);
    }
}

TEST(Array2, RowsAreItsValuesInOrder) {
    Array2<int> plane{2, 3};
    plane(1, 0) = 7;
    EXPECT_EQ(plane.row(1)[0], 7);
    EXPECT_EQ(plane.values()[3], 7);
    EXPECT_EQ(plane.row(1).size(), 3U);
}

/// Whoever uses buffers again asks for their size.
TEST(Arrays, AreEmptyOnceTheyWereMoved) {
    Array2<int> plane{2, 3};
    plane(1, 2) = 7;
    Array2<int> taken = std::move(plane);
    EXPECT_EQ(plane, Array2<int>{});  // NOLINT(bugprone-use-after-move): this is what is asked
    EXPECT_EQ(taken(1, 2), 7);
    plane = std::move(taken);
    EXPECT_EQ(taken.height(), 0);  // NOLINT(bugprone-use-after-move)
    EXPECT_EQ(plane(1, 2), 7);
    Array3<int> map{2, 3, 4};
    const Array3<int> taken_map = std::move(map);
    EXPECT_EQ(map, Array3<int>{});  // NOLINT(bugprone-use-after-move)
    EXPECT_EQ(taken_map.channels(), 4);
}

TEST(Arrays, OfNumbersAreFiniteOrNot) {
    Array2<float> map{5, 7};
    EXPECT_TRUE(is_finite(map));
    EXPECT_TRUE(is_finite(Array2<float>{}));
    constexpr float kMost = std::numeric_limits<float>::max(),
                    kInfinity = std::numeric_limits<float>::infinity();
    for (const float value : {kMost, -kMost, -0.0F, 1e-44F}) {
        map(4, 6) = value;
        EXPECT_TRUE(is_finite(map)) << value;
    }
    for (const float value : {kInfinity, -kInfinity, std::nanf(""), -std::nanf("1")}) {
        map(3, 2) = value;
        EXPECT_FALSE(is_finite(map)) << value;
    }
}

TEST(SensorTime, CarriesEpochStampsInMicroseconds) {
    const std::int64_t epoch_us = 1'700'000'000'123'456;
    EXPECT_EQ(to_us(from_us(epoch_us)), epoch_us);
    EXPECT_EQ((Window{from_us(epoch_us), from_us(epoch_us + 50)}).width().count(), 50);
}

TEST(Damage, IsCountedByReasonAndEveryReasonHasAName) {
    Damage damage;
    damage.count(DamageReason::truncated);
    damage.count(DamageReason::unknown_word, 4);
    EXPECT_EQ(damage[DamageReason::unknown_word], 4U);
    EXPECT_EQ(damage.total(), 5U);
    for (std::size_t i = 0; i < kDamageReasons; ++i) EXPECT_FALSE(name_of(DamageReason(i)).empty());
}

TEST(Array3, ALargeOneBeginsAtAHugePageAndIsZero) {
    constexpr std::uintptr_t kHugePage = std::uintptr_t{1} << 21;
    Array3<float> large{1024, 1025, 1};  // two of them, and 4 KiB more
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(large.values().data()) % kHugePage, 0U);
    EXPECT_EQ(std::ranges::count(large.values(), 0.0F), 1024 * 1025);
    large(1023, 1024, 0) = 1;
    Array3<float> copy = large, other{2, 3, 4};
    EXPECT_EQ(copy, large);
    std::swap(copy, other);
    EXPECT_EQ(other, large);
    EXPECT_EQ(copy, (Array3<float>{2, 3, 4}));
}

}  // namespace
}  // namespace eventide
