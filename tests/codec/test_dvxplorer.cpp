// DVXplorer (FX3): words, spelled out.
#include "src/codec/inivation/dvxplorer.h"

#include "tests/codec/usb_words.h"

#include <gmock/gmock.h>

namespace eventide::usb_words {
namespace {

using testing::ElementsAre;

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

/// Bit 11 of a column marks the first of a readout, bit 10 nothing.
TEST(Dvxplorer, AColumnHasTenBits) {
    const auto parsed = fx3(
        {time(5), column(0x800 | 0x400 | 7), groups(1, 20), group_1(1, false), group_2(1, true)});
    EXPECT_THAT(parsed.data.events,
                ElementsAre(event(5, 7, 8, Polarity::on), event(5, 7, 21 * 8, Polarity::off)));
}

TEST(Dvxplorer, ASecondGroupAboveTheFirstRowIsOutside) {
    const auto parsed = fx3({time(5), column(1), groups(2, 3, true), group_2(0b101, false)});
    EXPECT_TRUE(parsed.data.events.empty());
    EXPECT_EQ(parsed.damaged[DamageReason::out_of_range], 2U);
}

TEST(Dvxplorer, EventsWaitForTimeColumnAndRowsAlsoAfterALoss) {
    DvxplorerParser parser{{}};
    Batch data;
    for (int n = 0; n < 2; ++n) {
        parser.parse(bytes_of<std::uint16_t>(
                         {group_1(1, false), column(3), groups(2, 0), group_1(1, false)}),
                     data);
        EXPECT_TRUE(data.events.empty()) << "no time";
        parser.resync();
        parser.parse(bytes_of<std::uint16_t>({time(5), groups(2, 0), group_1(1, false)}), data);
        EXPECT_TRUE(data.events.empty()) << "no column";
        parser.resync();
        parser.parse(bytes_of<std::uint16_t>({time(5), column(3), group_1(1, false)}), data);
        EXPECT_TRUE(data.events.empty()) << "no rows";
        parser.parse(bytes_of<std::uint16_t>({groups(2, 0), group_1(1, false)}), data);
        EXPECT_THAT(data.events, ElementsAre(event(5, 3, 16, Polarity::on)));
        data.clear();
        parser.resync();
    }
    EXPECT_EQ(parser.damaged().total(), 0U);
}

/// Begin and end of an IMU sample, of which a loss or a reset took the middle.
TEST(Dvxplorer, AnImuSampleDoesNotGoOnBehindALossOrAReset) {
    constexpr std::uint16_t kReset = 1, kBegin = 5, kEnd = 7;
    const std::vector<std::uint16_t> first{time(5), kBegin, 0x53E0, 0x5001, 0x5002};
    const std::vector<std::uint16_t> rest(12, 0x5003);
    DvxplorerParser parser{{}};
    Batch data;
    parser.parse(bytes_of(first), data);
    parser.resync();
    parser.parse(bytes_of(rest), data);
    parser.parse(bytes_of<std::uint16_t>({time(9), kEnd}), data);
    parser.parse(bytes_of(first), data);
    parser.parse(bytes_of<std::uint16_t>({kReset}), data);
    parser.parse(bytes_of(rest), data);
    parser.parse(bytes_of<std::uint16_t>({time(9), kEnd}), data);
    EXPECT_TRUE(data.imu.empty());
}

TEST(Dvxplorer, AnImuSampleBehindALossWaitsForATime) {
    std::vector<std::uint16_t> words{5, 0x53E0};
    words.insert(words.end(), 14, 0x5003);
    words.push_back(7);
    DvxplorerParser parser{{}};
    Batch data;
    parser.parse(bytes_of(words), data);
    EXPECT_TRUE(data.imu.empty());
    parser.parse(bytes_of<std::uint16_t>({time(5)}), data);
    parser.parse(bytes_of(words), data);
    EXPECT_EQ(data.imu.size(), 1U);
    parser.resync();
    parser.parse(bytes_of(words), data);
    EXPECT_EQ(data.imu.size(), 1U);
}

TEST(Dvxplorer, AnImuSampleThatBeginsBeforeTheLastHasEndedCostsThatOne) {
    std::vector<std::uint16_t> words{time(5), 5, 0x53E0, 0x5001, 5, 0x53E0};
    words.insert(words.end(), 14, 0x5000);
    words.push_back(7);
    const auto parsed = fx3(words);
    EXPECT_EQ(parsed.data.imu.size(), 1U);
    EXPECT_EQ(parsed.damaged[DamageReason::bad_record], 1U);
}

TEST(Dvxplorer, WordsThatMeanNothingAreCounted) {
    const auto parsed = fx3({time(5), 5, 0x53E0, 0x5104, 0x5204, 0x6000, 6, 99});
    EXPECT_EQ(parsed.damaged[DamageReason::unknown_word], 5U);
}

TEST(Dvxplorer, HalfAWordIsDroppedAtALossAndCountedAtTheEnd) {
    DvxplorerParser parser{{}};
    Batch data;
    const std::vector<std::byte> half(1);
    parser.parse(half, data);
    parser.resync();
    parser.parse(bytes_of<std::uint16_t>({time(5), column(3), groups(2, 0), group_1(1, false)}),
                 data);
    EXPECT_THAT(data.events, ElementsAre(event(5, 3, 16, Polarity::on)));
    parser.finish(data);
    EXPECT_EQ(parser.damaged().total(), 0U);
    parser.parse(half, data);
    parser.finish(data);
    EXPECT_EQ(parser.damaged()[DamageReason::truncated], 1U);
}

TEST(Dvxplorer, TheTimeIsNotKnownBeforeAWordTellsIt) {
    DvxplorerParser parser{{}};
    Batch data;
    EXPECT_EQ(parser.clock(), std::nullopt);
    parser.parse(bytes_of<std::uint16_t>({time(5)}), data);
    EXPECT_EQ(parser.clock(), from_us(5));
    parser.resync();
    EXPECT_EQ(parser.clock(), std::nullopt);
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

TEST(Dvxplorer, SwappedAxesAreGivenAsAPersonSeesThem) {
    DvxplorerSensor sensor;
    sensor.swapped = true;  // 480 columns of 640 rows
    const auto parsed =
        parse(DvxplorerParser{sensor}, bytes_of<std::uint16_t>({time(5), column(479), groups(60, 0),
                                                                group_1(1, false), column(480)}));
    EXPECT_THAT(parsed.data.events, ElementsAre(event(5, 480, 479, Polarity::on)));
    EXPECT_EQ(parsed.damaged[DamageReason::out_of_range], 1U);
}

TEST(Dvxplorer, RandomBytesNeverHarmAndSplitsNeverMatter) {
    expect_survives([] { return DvxplorerParser{{}}; });
}

}  // namespace
}  // namespace eventide::usb_words
