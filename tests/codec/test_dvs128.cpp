// DVS128 words, spelled out.
#include "src/codec/inivation/dvs128.h"

#include "tests/codec/usb_words.h"

#include <gmock/gmock.h>

namespace eventide::usb_words {
namespace {

using testing::ElementsAre;

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

TEST(Dvs128, AnEdgeOnTheSynchronizationInputIsATrigger) {
    const auto parsed = parse(
        Dvs128Parser{}, bytes_of<std::uint32_t>({dvs128(0, 127, false, 9), 10U << 16 | 0x8000U}));
    EXPECT_THAT(parsed.data.events, ElementsAre(event(9, 127, 0, Polarity::on)));
    EXPECT_THAT(parsed.data.triggers, ElementsAre(Trigger{from_us(10), Trigger::Kind::rising, 0}));
}

TEST(Dvs128, AnEventBeforeTheLastIsLeftOutAndCounted) {
    const auto parsed = parse(
        Dvs128Parser{}, bytes_of<std::uint32_t>({dvs128(0, 0, false, 100), dvs128(1, 0, false, 99),
                                                 dvs128(2, 0, false, 100)}));
    EXPECT_THAT(parsed.data.events, ElementsAre(event(100, 127, 127, Polarity::on),
                                                event(100, 125, 127, Polarity::on)));
    EXPECT_EQ(parsed.damaged[DamageReason::time_backwards], 1U);
}

TEST(Dvs128, SoIsAnEdgeBeforeTheLastEvent) {
    const auto parsed = parse(
        Dvs128Parser{}, bytes_of<std::uint32_t>({dvs128(0, 0, false, 100), 99U << 16 | 0x8000U}));
    EXPECT_TRUE(parsed.data.triggers.empty());
    EXPECT_EQ(parsed.damaged[DamageReason::time_backwards], 1U);
}

TEST(Dvs128, AWrapIsNoResetWhateverItsOtherBitsSay) {
    const auto parsed = parse(
        Dvs128Parser{},
        bytes_of<std::uint32_t>({dvs128(0, 0, false, 100), 0xC0000000U, dvs128(0, 0, false, 5)}));
    EXPECT_EQ(to_us(parsed.data.events.at(1).t), 16384 + 5);
    EXPECT_TRUE(parsed.data.triggers.empty());
}

TEST(Dvs128, HalfARecordIsLostInAGapAndCountedAtTheEnd) {
    const auto bytes =
        bytes_of<std::uint32_t>({dvs128(0, 0, false, 100), dvs128(1, 0, false, 101)});
    Dvs128Parser parser;
    Batch data;
    parser.parse(std::span{bytes}.first(6), data);
    parser.resync();
    parser.parse(std::span{bytes}.last(4), data);
    EXPECT_THAT(data.events, ElementsAre(event(100, 127, 127, Polarity::on),
                                         event(101, 126, 127, Polarity::on)));
    parser.parse(std::span{bytes}.first(3), data);
    EXPECT_EQ(parser.damaged().total(), 0U);
    parser.finish(data);
    EXPECT_EQ(parser.damaged()[DamageReason::truncated], 1U);
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

TEST(Dvs128, RandomBytesNeverHarmAndSplitsNeverMatter) {
    expect_survives([] { return Dvs128Parser{}; });
}

}  // namespace
}  // namespace eventide::usb_words
