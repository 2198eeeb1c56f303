// DVXplorer Mini (CX3): words and messages, spelled out.
#include "src/codec/inivation/dvxplorer_mini.h"
#include "src/core/byte_order.h"
#include "tests/codec/usb_words.h"

#include <gmock/gmock.h>

namespace eventide::usb_words {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::FloatEq;
using testing::IsEmpty;

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
    EXPECT_EQ(parsed.damaged.total(), 0U) << "a word of 0 is padding";
}

TEST(DvxplorerMini, GroupsHaveSixBitsAndTheSecondIsUpToThirtyOneBehind) {
    const auto parsed = parse(
        DvxplorerMiniParser{{}},
        bytes_of<std::uint32_t>({reference(2), frame32(7, 0), pair(40, 19, 1, 1, false, true)}));
    EXPECT_THAT(parsed.data.events,
                ElementsAre(event(2000, 7, 320, Polarity::on), event(2000, 7, 472, Polarity::off)));
}

TEST(DvxplorerMini, AReferenceALittleBeforeTheLastIsNoise) {
    const auto parsed = parse(DvxplorerMiniParser{{}},
                              bytes_of<std::uint32_t>({reference(5), reference(4), frame32(7, 30),
                                                       pair(0, 0, 1, 0, false, false)}));
    EXPECT_THAT(parsed.data.events, ElementsAre(event(5030, 7, 0, Polarity::on)));
    EXPECT_EQ(parsed.damaged[DamageReason::time_backwards], 1U);
    EXPECT_EQ(parsed.damaged.total(), 1U);
}

TEST(DvxplorerMini, AReferenceLessThanHalfTheRangeBeforeTheLastIsNoiseToo) {
    const auto parsed =
        parse(DvxplorerMiniParser{{}},
              bytes_of<std::uint32_t>({reference(4'000'000), reference(1'910'000), frame32(7, 0),
                                       pair(0, 0, 1, 0, false, false)}));
    EXPECT_THAT(parsed.data.events, ElementsAre(event(4'000'000'000, 7, 0, Polarity::on)));
    EXPECT_EQ(parsed.damaged[DamageReason::time_backwards], 1U);
}

/// Ten bits of microseconds reach beyond the next millisecond.
TEST(DvxplorerMini, AFrameBeforeTheLastOneIsLeftOutThoughItsReferenceIsLater) {
    const auto parsed = parse(
        DvxplorerMiniParser{{}},
        bytes_of<std::uint32_t>({reference(2), frame32(7, 1010), pair(0, 0, 1, 0, false, false),
                                 reference(3), frame32(8, 5), pair(0, 0, 1, 0, false, false)}));
    EXPECT_THAT(parsed.data.events, ElementsAre(event(3010, 7, 0, Polarity::on)));
    EXPECT_EQ(parsed.damaged[DamageReason::time_backwards], 1U);
}

/// A second of the host's clock passes, or nobody knows how much.
TEST(DvxplorerMini, ACameraThatCameBackAndCountsFromAnywhereGoesOn) {
    for (const std::uint32_t ms : {0U, 900U, 9'000U, 4'000'000U})
        for (const bool host : {true, false}) {
            DvxplorerMiniParser parser{{}};
            Batch data;
            if (host) parser.arrives(HostTime{});
            parser.parse(bytes_of<std::uint32_t>({reference(1'000)}), data);
            parser.resync();
            if (host) parser.arrives(HostTime{std::chrono::seconds{5}});
            parser.parse(bytes_of<std::uint32_t>(
                             {reference(ms), frame32(7, 30), pair(0, 0, 1, 0, false, false)}),
                         data);
            // Without a host's clock what is later than before is believed.
            const std::int64_t expected = host ? 6'000'000 : std::max(ms, 1'000U) * 1'000LL;
            ASSERT_EQ(data.events.size(), 1U);
            EXPECT_EQ(to_us(data.events[0].t), expected + 30) << ms << ", " << host;
        }
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

TEST(DvxplorerMini, OfAColumnThatIsNoneNothingComes) {
    const auto one = pair(0, 0, 1, 0, false, false);
    const auto outside = parse(DvxplorerMiniParser{{}},
                               bytes_of<std::uint32_t>({reference(1), frame32(5, 1), one,
                                                        column32(640), one, column32(7), one}));
    EXPECT_THAT(outside.data.events, ElementsAre(event(1001, 5, 0, Polarity::on)))
        << "up to the next frame";
    EXPECT_EQ(outside.damaged[DamageReason::out_of_range], 1U);
    const auto twice =
        parse(DvxplorerMiniParser{{}},
              bytes_of<std::uint32_t>({reference(1), frame32(5, 1), one, column32(5), one}));
    EXPECT_EQ(twice.data.events.size(), 1U);
    EXPECT_EQ(twice.damaged[DamageReason::bad_record], 1U);
}

TEST(DvxplorerMini, BehindALossEventsWaitForAFrame) {
    const auto one = pair(0, 0, 1, 0, false, false);
    DvxplorerMiniParser parser{{}};
    Batch data;
    parser.parse(bytes_of<std::uint32_t>({reference(1), frame32(5, 1), one}), data);
    parser.resync();
    data.clear();
    parser.parse(bytes_of<std::uint32_t>({reference(2), one, column32(9), one}), data);
    EXPECT_TRUE(data.events.empty());
    parser.parse(bytes_of<std::uint32_t>({frame32(3, 1), one}), data);
    EXPECT_THAT(data.events, ElementsAre(event(2001, 3, 0, Polarity::on)));
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
    constexpr std::byte kImu{1}, kLetter{'A'}, kNoKind{0xFF};
    for (const std::byte all : {kImu, kLetter, kNoKind})
        for (const std::size_t length : {0, 1, 15, 16, 17, 64}) {
            if (all == kImu && length == 16) continue;  // that is one
            auto bytes = bytes_of<std::uint32_t>({reference(1)});
            std::vector<std::byte> text(length, all);
            frame_mini_message(text);
            bytes.insert(bytes.end(), text.begin(), text.end());
            const auto after =
                bytes_of<std::uint32_t>({frame32(5, 1), pair(0, 0, 1, 0, false, false)});
            bytes.insert(bytes.end(), after.begin(), after.end());
            const auto parsed = parse(DvxplorerMiniParser{{}}, bytes);
            EXPECT_THAT(parsed.data.events, ElementsAre(event(1001, 5, 0, Polarity::on))) << length;
            EXPECT_THAT(parsed.data.imu, IsEmpty());
            EXPECT_EQ(parsed.damaged[DamageReason::unknown_word], 1U);
            EXPECT_EQ(parsed.damaged.total(), 1U);
        }
}

TEST(DvxplorerMini, AnImuSampleBeforeTheFirstReferenceHasNoTimeAndIsLeftOut) {
    auto bytes = mini_imu(0xE0);
    const auto first = bytes_of<std::uint32_t>({reference(7)});
    bytes.insert(bytes.end(), first.begin(), first.end());
    const auto parsed = parse(DvxplorerMiniParser{{}}, bytes);
    EXPECT_THAT(parsed.data.imu, IsEmpty());
    EXPECT_EQ(parsed.damaged.total(), 0U);
}

TEST(DvxplorerMini, ARowBelowTheSensorIsOutside) {
    const auto parsed = parse(
        DvxplorerMiniParser{{}},
        bytes_of<std::uint32_t>({reference(2), frame32(7, 0), pair(59, 1, 0x80, 1, false, false)}));
    EXPECT_THAT(parsed.data.events, ElementsAre(event(2000, 7, 479, Polarity::on)));
    EXPECT_EQ(parsed.damaged[DamageReason::out_of_range], 1U);
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

TEST(DvxplorerMini, RandomBytesNeverHarmAndSplitsNeverMatter) {
    expect_survives([] { return DvxplorerMiniParser{{}}; });
}

}  // namespace
}  // namespace eventide::usb_words
