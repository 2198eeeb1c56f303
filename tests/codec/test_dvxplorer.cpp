// DVXplorer and DVS128 words, spelled out.
#include "src/codec/inivation/dvs128.h"
#include "src/codec/inivation/dvxplorer.h"
#include "src/codec/inivation/dvxplorer_mini.h"
#include "src/core/byte_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace eventide {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::FloatEq;

// The vocabulary of docs/protocols.md A.12.
constexpr std::uint16_t time(int low15) {
    return std::uint16_t(0x8000 | low15);
}
constexpr std::uint16_t column(int x) {
    return std::uint16_t(0x1000 | x);
}
constexpr std::uint16_t groups(int first, int offset, bool before = false) {
    return std::uint16_t(0x4000 | first | (offset << 6) | (before ? 0x800 : 0));
}
constexpr std::uint16_t group_1(int mask, bool off) {
    return std::uint16_t(0x3000 | mask | (off ? 0x100 : 0));
}
constexpr std::uint16_t group_2(int mask, bool off) {
    return std::uint16_t(0x2000 | mask | (off ? 0x100 : 0));
}

template <typename Word>
std::vector<std::byte> bytes_of(const std::vector<Word>& words) {
    std::vector<std::byte> bytes;
    for (const Word w : words)
        for (std::size_t i = 0; i < sizeof(Word); ++i)
            bytes.push_back(std::byte((w >> (8 * i)) & 0xFF));
    return bytes;
}

struct Parsed {
    Batch data;
    Damage damaged;
};

template <typename P>
Parsed parse(P parser, const std::vector<std::byte>& bytes, std::size_t piece = 3) {
    Parsed parsed;
    for (std::size_t at = 0; at < bytes.size(); at += piece)
        parser.parse(std::span{bytes}.subspan(at, std::min(piece, bytes.size() - at)), parsed.data);
    parser.finish(parsed.data);
    parsed.damaged = parser.damaged();
    return parsed;
}

Event event(std::int64_t t, int x, int y, Polarity polarity) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), polarity};
}

Parsed fx3(const std::vector<std::uint16_t>& words) {
    return parse(DvxplorerParser{{}}, bytes_of(words));
}

TEST(Dvxplorer, MasksOfTwoGroupsOfRowsMakeEvents) {
    const auto parsed =
        fx3({time(5), column(100), groups(2, 3), group_1(0b1000'0001, false), group_2(0b10, true)});
    EXPECT_THAT(parsed.data.events,
                ElementsAre(event(5, 100, 16, Polarity::on), event(5, 100, 23, Polarity::on),
                            event(5, 100, 41, Polarity::off)));
    EXPECT_EQ(parsed.damaged.total(), 0U);
}

TEST(Dvxplorer, TheSecondGroupMayComeBeforeTheFirst) {
    const auto parsed = fx3({time(5), column(1), groups(4, 3, true), group_2(1, false)});
    EXPECT_THAT(parsed.data.events, ElementsAre(event(5, 1, 8, Polarity::on)));
}

TEST(Dvxplorer, OutsideTheSensorIsCounted) {
    const auto parsed = fx3({time(5), column(640), groups(0, 0), group_1(1, false), column(0),
                             groups(60, 0), group_1(3, false)});
    EXPECT_TRUE(parsed.data.events.empty());
    EXPECT_EQ(parsed.damaged[DamageReason::out_of_range], 3U);
}

TEST(Dvxplorer, EdgesSayWhetherTheyAreOfTheInputOrTheGenerator) {
    using Kind = Trigger::Kind;
    const auto parsed = fx3({2, time(9), 2, 3, 4, time(10), 16, 17});
    const std::vector<Trigger> expected{{from_us(9), Kind::falling, 0},
                                        {from_us(9), Kind::rising, 0},
                                        {from_us(9), Kind::pulse, 0},
                                        {from_us(10), Kind::falling, Trigger::kGenerator},
                                        {from_us(10), Kind::rising, Trigger::kGenerator}};
    EXPECT_EQ(parsed.data.triggers, expected) << "the first has no time";
    EXPECT_EQ(parsed.damaged.total(), 0U);
}

TEST(Dvxplorer, ImuSendsYBeforeXAndHasItsOwnScales) {
    std::vector<std::uint16_t> words{
        time(9), 5, std::uint16_t(0x5300 | 0xE0 | (1 << 3) | 2)};  // 4 g, 500 deg/s
    for (const int value : {8192, -8192, 0, 512, 6554, 0, 0})
        for (const int shift : {8, 0})
            words.push_back(std::uint16_t(0x5000 | ((std::uint16_t(value) >> shift) & 0xFF)));
    words.push_back(7);
    const auto parsed = fx3(words);
    ASSERT_EQ(parsed.data.imu.size(), 1U);
    EXPECT_EQ(parsed.data.imu[0].acceleration_g, (std::array<float, 3>{-1, 1, 0}));
    EXPECT_NEAR(parsed.data.imu[0].gyro_dps[1], 100, .1);
    EXPECT_EQ(parsed.data.imu[0].temperature_c, 24);
}

// CX3: 32-bit words.
constexpr std::uint32_t reference(std::uint32_t ms) {
    return 0x08000000U | ms;
}
constexpr std::uint32_t column32(std::uint32_t x) {
    return 0x04000000U | x;
}
constexpr std::uint32_t frame32(std::uint32_t x, std::uint32_t after_us) {  // the first column
    return column32(x) | (1U << 21) | (after_us << 11);
}
constexpr std::uint32_t pair(std::uint32_t first, std::uint32_t offset, std::uint32_t mask_1,
                             std::uint32_t mask_2, bool off_1, bool off_2) {
    return (1U << 31) | (first << 18) | (offset << 26) | mask_1 | (mask_2 << 8) |
           (off_1 ? 1U << 16 : 0) | (off_2 ? 1U << 17 : 0);
}

TEST(DvxplorerMini, ReferenceColumnAndGroupWordsMakeEvents) {
    const auto parsed =
        parse(DvxplorerMiniParser{{}}, bytes_of<std::uint32_t>({reference(2), frame32(7, 30), 0,
                                                                pair(1, 2, 1, 0x80, false, true)}));
    EXPECT_THAT(parsed.data.events,
                ElementsAre(event(2030, 7, 8, Polarity::on), event(2030, 7, 31, Polarity::off)));
}

TEST(DvxplorerMini, ReferenceTimeWrapsAfterSeventyMinutes) {
    const auto parsed =
        parse(DvxplorerMiniParser{{}},
              bytes_of<std::uint32_t>({reference((1 << 22) - 1), reference(0), frame32(1, 0),
                                       pair(0, 0, 1, 0, false, false)}));
    ASSERT_EQ(parsed.data.events.size(), 1U);
    EXPECT_EQ(to_us(parsed.data.events[0].t), std::int64_t{1 << 22} * 1000);
}

TEST(DvxplorerMini, ColumnsOfAFrameShareItsTime) {
    const auto parsed =
        parse(DvxplorerMiniParser{{}},
              bytes_of<std::uint32_t>({reference(1), column32(3), pair(0, 0, 1, 0, false, false),
                                       frame32(5, 700), pair(0, 0, 1, 0, false, false),
                                       reference(2), column32(9), pair(0, 0, 2, 0, false, false),
                                       frame32(0, 10), pair(0, 0, 4, 0, false, false)}));
    // What comes before the first frame has no time; a reference between does not change a frame's.
    EXPECT_THAT(parsed.data.events,
                ElementsAre(event(1700, 5, 0, Polarity::on), event(2000, 9, 1, Polarity::on),
                            event(2010, 0, 2, Polarity::on)));
    EXPECT_EQ(parsed.damaged.total(), 0U);
}

// A lost reference leaves later frames a millisecond or more too early, unless they wait for one.
TEST(DvxplorerMini, AColumnThatDoesNotRiseTellsOfALossUntilTheNextReference) {
    const auto one = pair(0, 0, 1, 0, false, false);
    const auto parsed = parse(
        DvxplorerMiniParser{{}},
        bytes_of<std::uint32_t>({reference(1), frame32(5, 1), one, column32(4), one, column32(6),
                                 one, frame32(7, 2), one, reference(4), frame32(8, 3), one}));
    EXPECT_THAT(parsed.data.events,
                ElementsAre(event(1001, 5, 0, Polarity::on), event(4003, 8, 0, Polarity::on)));
    EXPECT_EQ(parsed.damaged[DamageReason::bad_record], 1U);
}

TEST(DvxplorerMini, AFrameBeforeTheLastTellsOfALossUntilTheNextReference) {
    const auto one = pair(0, 0, 1, 0, false, false);
    const auto parsed =
        parse(DvxplorerMiniParser{{}},
              bytes_of<std::uint32_t>({reference(1), frame32(5, 700), one, frame32(5, 200), one,
                                       frame32(5, 800), one, reference(3), frame32(5, 10), one}));
    EXPECT_THAT(parsed.data.events,
                ElementsAre(event(1700, 5, 0, Polarity::on), event(3010, 5, 0, Polarity::on)));
    EXPECT_EQ(parsed.damaged[DamageReason::time_backwards], 1U);
}

TEST(DvxplorerMini, ACameraThatCameBackCountsFromZeroAndTimeGoesOn) {
    DvxplorerMiniParser parser{{}};
    Batch data;
    const auto tell = [&](std::uint32_t ms) {
        parser.parse(
            bytes_of<std::uint32_t>({reference(ms), frame32(1, 0), pair(0, 0, 1, 0, false, false)}),
            data);
        return to_us(data.events.back().t);
    };
    parser.arrives(HostTime{});
    EXPECT_EQ(tell(50'000), 50'000'000);
    parser.resync();
    parser.arrives(HostTime{SensorDuration{5'000'000}});
    EXPECT_EQ(tell(55'001), 55'001'000);  // it went on all the time
    parser.resync();
    parser.arrives(HostTime{SensorDuration{10'000'000}});
    EXPECT_EQ(tell(3), 60'001'000);  // it was plugged in anew
    EXPECT_EQ(tell(13), 60'011'000);
}

std::vector<std::byte> mini_imu(std::uint8_t flags) {
    // Kind and flags; gyroscope z y x, accelerometer z y x, temperature, each little-endian.
    std::vector<std::byte> message = bytes_of<std::uint8_t>({1, flags});
    for (const int v : {3000, -200, 100, 16384, 8192, -4096, 512})
        append_little(message, std::int16_t(v));
    frame_mini_message(message);
    return message;
}

TEST(DvxplorerMini, AMessageBesideTheDataIsAnImuSampleOfThatMoment) {
    DvxplorerSensor sensor;
    sensor.imu_flip_y = true;
    auto bytes = bytes_of<std::uint32_t>({reference(7)});
    const auto message = mini_imu(0xE0 | (1 << 3) | 2);  // 4 g, 500 deg/s
    bytes.insert(bytes.end(), message.begin(), message.end());
    const auto parsed = parse(DvxplorerMiniParser{sensor}, bytes);
    ASSERT_EQ(parsed.data.imu.size(), 1U);
    const ImuSample& sample = parsed.data.imu[0];
    EXPECT_EQ(to_us(sample.t), 7000);
    EXPECT_THAT(sample.acceleration_g, ElementsAre(-.5F, -1.F, 2.F));
    EXPECT_THAT(sample.gyro_dps,
                ElementsAre(FloatEq(100 * 500 / 32768.F), FloatEq(200 * 500 / 32768.F),
                            FloatEq(3000 * 500 / 32768.F)));
    EXPECT_FLOAT_EQ(sample.temperature_c, 24);
    EXPECT_EQ(parsed.damaged.total(), 0U);
}

TEST(DvxplorerMini, PartsOfAnImuSampleThatAreNotThereAreZero) {
    auto bytes = bytes_of<std::uint32_t>({reference(7)});
    const auto message = mini_imu(0x80);
    bytes.insert(bytes.end(), message.begin(), message.end());
    const auto parsed = parse(DvxplorerMiniParser{{}}, bytes);
    ASSERT_EQ(parsed.data.imu.size(), 1U);
    EXPECT_THAT(parsed.data.imu[0].gyro_dps, Each(0));
    EXPECT_FLOAT_EQ(parsed.data.imu[0].acceleration_g[0], -.25F);
    EXPECT_FLOAT_EQ(parsed.data.imu[0].temperature_c, 0);
}

TEST(DvxplorerMini, OtherMessagesAreCountedAndWhatFollowsIsWhole) {
    for (const std::size_t length : {1, 15, 17, 64}) {
        auto bytes = bytes_of<std::uint32_t>({reference(1)});
        std::vector<std::byte> text(length, std::byte{0xFF});
        frame_mini_message(text);
        bytes.insert(bytes.end(), text.begin(), text.end());
        const auto after = bytes_of<std::uint32_t>({frame32(5, 1), pair(0, 0, 1, 0, false, false)});
        bytes.insert(bytes.end(), after.begin(), after.end());
        const auto parsed = parse(DvxplorerMiniParser{{}}, bytes);
        EXPECT_THAT(parsed.data.events, ElementsAre(event(1001, 5, 0, Polarity::on))) << length;
        EXPECT_EQ(parsed.damaged[DamageReason::unknown_word], 1U);
        EXPECT_EQ(parsed.damaged.total(), 1U);
    }
}

TEST(DvxplorerMini, AMessageCutOffByALossOrTheEndIsNoSample) {
    const auto message = mini_imu(0xE0);
    for (std::size_t cut = 4; cut < message.size(); cut += 4) {
        DvxplorerMiniParser parser{{}};
        Batch data;
        parser.parse(bytes_of<std::uint32_t>({reference(1)}), data);
        parser.parse(std::span{message}.first(cut), data);
        parser.resync();
        parser.parse(
            bytes_of<std::uint32_t>({reference(2), frame32(5, 1), pair(0, 0, 1, 0, false, false)}),
            data);
        EXPECT_THAT(data.events, ElementsAre(event(2001, 5, 0, Polarity::on)));
        parser.parse(std::span{message}.first(cut), data);
        parser.finish(data);
        EXPECT_EQ(parser.damaged()[DamageReason::truncated], 1U);
        EXPECT_TRUE(data.imu.empty());
    }
}

TEST(Dvxplorer, SwappedAxesAreGivenAsAPersonSeesThem) {
    DvxplorerSensor sensor;
    sensor.swapped = true;  // 480 columns of 640 rows
    const auto parsed =
        parse(DvxplorerParser{sensor}, bytes_of<std::uint16_t>({time(5), column(479), groups(60, 0),
                                                                group_1(1, false), column(480)}));
    EXPECT_THAT(parsed.data.events, ElementsAre(event(5, 480, 479, Polarity::on)));
    EXPECT_EQ(parsed.damaged[DamageReason::out_of_range], 1U);
}

// DVS128.
std::uint32_t dvs128(int x, int y, bool off, int low14) {
    return std::uint32_t((off ? 1 : 0) | (x << 1) | (y << 8)) | (std::uint32_t(low14) << 16);
}

TEST(Dvs128, IsMirroredAndWrapsEvery16384Us) {
    const auto parsed = parse(
        Dvs128Parser{},
        bytes_of<std::uint32_t>({dvs128(0, 0, false, 100), 0x80000000U, dvs128(127, 3, true, 5)}));
    EXPECT_THAT(parsed.data.events, ElementsAre(event(100, 127, 127, Polarity::on),
                                                event(16384 + 5, 0, 124, Polarity::off)));
}

TEST(Dvs128, TimeGoesOnThroughAReset) {
    const auto parsed = parse(
        Dvs128Parser{},
        bytes_of<std::uint32_t>({dvs128(0, 0, false, 100), 0x40000000U, dvs128(0, 0, false, 1)}));
    EXPECT_EQ(to_us(parsed.data.events.at(1).t), 101);
    EXPECT_EQ(parsed.data.triggers.size(), 1U);
}

TEST(Dvs128, LostWrapsAreFoundFromTheHostsClock) {
    Dvs128Parser parser;
    Batch data;
    parser.arrives(HostTime{});
    parser.parse(bytes_of<std::uint32_t>({dvs128(0, 0, false, 100)}), data);
    parser.resync();
    EXPECT_EQ(parser.clock(), std::nullopt);
    parser.arrives(HostTime{SensorDuration{10 * 16384 + 7}});
    parser.parse(bytes_of<std::uint32_t>({dvs128(0, 0, false, 101)}), data);
    EXPECT_EQ(to_us(data.events.at(1).t), 10 * 16384 + 101);
}

template <typename P>
void survive(P make) {
    std::mt19937 rng{7};
    for (int round = 0; round < 200; ++round) {
        std::vector<std::byte> bytes(1 + rng() % 3000);
        for (auto& b : bytes) b = std::byte(rng());
        const auto whole = parse(make(), bytes, bytes.size()),
                   split = parse(make(), bytes, 1 + rng() % 50);
        ASSERT_EQ(whole.data.events, split.data.events);
        for (std::size_t i = 1; i < whole.data.events.size(); ++i)
            ASSERT_LE(whole.data.events[i - 1].t, whole.data.events[i].t);
    }
}

TEST(Dvxplorer, RandomBytesNeverHarmAndSplitsNeverMatter) {
    survive([] { return DvxplorerParser{{}}; });
    survive([] { return DvxplorerMiniParser{{}}; });
    survive([] { return Dvs128Parser{}; });
}

}  // namespace
}  // namespace eventide
