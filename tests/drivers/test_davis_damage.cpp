// Words of a DAVIS that make no sense: counted by reason, and the rest is whole.
#include "src/core/byte_order.h"
#include "tests/drivers/davis_streams.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

namespace eventide::test {
namespace {

using testing_support::DavisModelSettings;

// docs/protocols.md A.9.
constexpr std::uint16_t kTime = 0x8000, kRow = 0x1000, kOffColumn = 0x2000, kImuByte = 0x5000;
constexpr std::uint16_t kImuStart = 5, kColumnEnd = 13;

using Words = std::vector<std::uint16_t>;

/// A fault in the words of every stretch of the stream.
DavisModelSettings spoiled_by(std::function<void(Words&)> spoil) {
    DavisModelSettings settings;
    settings.spoil = [spoil = std::move(spoil)](std::vector<std::byte>& bytes) {
        Words words(bytes.size() / 2);
        for (std::size_t i = 0; i < words.size(); ++i)
            words[i] = load_little<std::uint16_t>(&bytes[2 * i]);
        spoil(words);
        bytes.clear();
        for (const std::uint16_t w : words) {
            bytes.push_back(std::byte(w & 0xFF));
            bytes.push_back(std::byte(w >> 8));
        }
    };
    return settings;
}

TEST(DavisDamage, PlacesOutsideTheSensorAreCountedAndLeftOut) {
    std::uint64_t made = 0;
    PluggedIn camera_side{spoiled_by([&](Words& words) {
        const auto row = std::find_if(words.rbegin(), words.rend(),
                                      [](std::uint16_t w) { return (w & 0xF000) == kRow; });
        if (row == words.rend()) return;
        // A column too far right, a row too far down, and back to the row before.
        for (const std::uint16_t w : {std::uint16_t(kOffColumn | 260), std::uint16_t(kRow | 346),
                                      std::uint16_t(kOffColumn | 0), *row})
            words.push_back(w);
        made += 2;
    })};
    const Streamed got = streamed_by(camera_side);
    EXPECT_GT(made, 2U);
    EXPECT_EQ(got.damaged[DamageReason::out_of_range], made);
    EXPECT_EQ(got.damaged.total(), made);
    EXPECT_EQ(got.data.events, camera_side.seen.events);
}

TEST(DavisDamage, ATimeSaidTwiceIsNoDamageAndATimeBeforeIsCounted) {
    std::uint64_t steps_back = 0;
    PluggedIn camera_side{spoiled_by([&](Words& words) {
        Words doubled;
        for (const std::uint16_t w : words) {
            doubled.push_back(w);
            if ((w & kTime) != 0) doubled.push_back(w);
        }
        const auto time = std::find_if(words.rbegin(), words.rend(),
                                       [](std::uint16_t w) { return (w & kTime) != 0; });
        if (time != words.rend() && *time > kTime) {
            doubled.push_back(std::uint16_t(*time - 1));
            ++steps_back;
        }
        words = doubled;
    })};
    const Streamed got = streamed_by(camera_side);
    EXPECT_GT(steps_back, 1U);
    EXPECT_EQ(got.damaged[DamageReason::time_backwards], steps_back);
    EXPECT_EQ(got.damaged.total(), steps_back);
    EXPECT_EQ(got.data.events, camera_side.seen.events);
}

TEST(DavisDamage, AFrameWithoutAColumnsEndIsLeftOutAndCounted) {
    PluggedIn camera_side{spoiled_by([done = false](Words& words) mutable {
        const auto end = std::find(words.begin(), words.end(), kColumnEnd);
        if (done || end == words.end()) return;
        words.erase(end);
        done = true;
    })};
    const Streamed got = streamed_by(camera_side);
    ASSERT_EQ(got.data.images.size(), 2U);
    EXPECT_EQ(got.data.images[0], camera_side.seen.images[1]);
    EXPECT_EQ(got.damaged[DamageReason::bad_record], 1U);
    EXPECT_EQ(got.damaged.total(), 1U);
    EXPECT_EQ(got.data.events, camera_side.seen.events);
}

TEST(DavisDamage, ACutImuSampleIsLeftOutAndCounted) {
    PluggedIn camera_side{spoiled_by([done = false](Words& words) mutable {
        const auto start = std::find(words.begin(), words.end(), kImuStart);
        if (done || start == words.end()) return;
        ASSERT_EQ(start[5] & 0xFF00, kImuByte);
        words.erase(start + 5);
        done = true;
    })};
    const Streamed got = streamed_by(camera_side);
    EXPECT_EQ(got.data.imu.size(), 2U);
    EXPECT_EQ(got.damaged[DamageReason::bad_record], 1U);
    EXPECT_EQ(got.damaged.total(), 1U);
    EXPECT_EQ(got.data.events, camera_side.seen.events);
}

}  // namespace
}  // namespace eventide::test
