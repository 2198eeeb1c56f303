// AEDAT 1.0 and 2.0, from words written as the format's description says.
#include "src/codec/aedat/aedat2.h"

#include "src/core/error.h"
#include "tests/codec/parser_checks.h"

#include <string>

namespace eventide {
namespace {

constexpr int kWidth = 240, kHeight = 180;

Bytes big_endian(std::uint32_t value, int bytes) {
    Bytes out;
    for (int i = bytes - 1; i >= 0; --i) out.push_back(std::byte(value >> (8 * i) & 0xFF));
    return out;
}

Bytes record(std::uint32_t address, std::int64_t t) {
    Bytes out = big_endian(address, 4), time = big_endian(std::uint32_t(t), 4);
    out.insert(out.end(), time.begin(), time.end());
    return out;
}

/// x, y as in the image; the chip counts from the lower left, X mirrored.
Bytes dvs(int x, int y, bool on, std::int64_t t) {
    return record(std::uint32_t(kHeight - 1 - y) << 22 | std::uint32_t(kWidth - 1 - x) << 12 |
                      std::uint32_t(on) << 11,
                  t);
}
Bytes external(std::int64_t t) {
    return record(1U << 10, t);
}
Bytes aps(bool is_signal, int x, int y, int sample, std::int64_t t, int height = kHeight) {
    return record(1U << 31 | std::uint32_t(height - 1 - y) << 22 | std::uint32_t(x) << 12 |
                      std::uint32_t(is_signal) << 10 | std::uint32_t(sample),
                  t);
}
Bytes imu(unsigned measure, std::int16_t value, std::int64_t t) {
    return record(1U << 31 | measure << 28 | std::uint32_t(std::uint16_t(value)) << 12 | 3U << 10,
                  t);
}

Bytes join(const std::vector<Bytes>& parts) {
    Bytes all;
    for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

MakeParser davis(int width = kWidth, int height = kHeight) {
    return [=] { return std::make_unique<Aedat2Parser>(Aedat2Sensor::davis, width, height); };
}
MakeParser dvs128(bool one_is_on = false) {
    return
        [=] { return std::make_unique<Aedat2Parser>(Aedat2Sensor::dvs128, 128, 128, one_is_on); };
}

TEST(Aedat2, DavisEventsHaveTheirOriginAtTheTopLeft) {
    const Parsed parsed = parse_whole(
        davis(), join({dvs(0, 0, true, 10), dvs(239, 179, false, 11), dvs(5, 170, true, 11)}));
    const std::vector<Event> expected{{from_us(10), 0, 0, Polarity::on},
                                      {from_us(11), 239, 179, Polarity::off},
                                      {from_us(11), 5, 170, Polarity::on}};
    EXPECT_EQ(parsed.data.events, expected);
    EXPECT_EQ(parsed.damage.total(), 0U);
    // X = 0 in the address is the right border, Y = 0 the lowest row.
    const Parsed zero = parse_whole(davis(), record(0, 1));
    EXPECT_EQ(zero.data.events.at(0), (Event{from_us(1), 239, 179, Polarity::off}));
}

TEST(Aedat2, Dvs128ZeroIsOnUnlessStatedOtherwise) {
    // y 3 from below, x 5 from the right.
    const Bytes bytes = record(3U << 8 | 5U << 1 | 0, 7);
    EXPECT_EQ(parse_whole(dvs128(), bytes).data.events.at(0),
              (Event{from_us(7), 122, 124, Polarity::on}));
    EXPECT_EQ(parse_whole(dvs128(true), bytes).data.events.at(0).polarity, Polarity::off);
}

TEST(Aedat2, EdgesOnTheExternalInputAreTriggers) {
    const Parsed parsed = parse_whole(davis(), join({external(5), dvs(1, 1, true, 6)}));
    ASSERT_EQ(parsed.data.triggers.size(), 1U);
    EXPECT_EQ(parsed.data.triggers[0], (Trigger{from_us(5), Trigger::Kind::pulse, 0}));
    EXPECT_EQ(parse_whole(dvs128(), record(0x8000, 5)).data.triggers.size(), 1U);
}

TEST(Aedat2, SevenWordsMakeAnImuSample) {
    const Parsed parsed = parse_whole(
        davis(), join({imu(0, 8192, 20), imu(1, -4096, 20), imu(2, 0, 20), imu(3, 340, 20),
                       imu(4, 655, 20), imu(5, -655, 20), imu(6, 131, 20)}));
    ASSERT_EQ(parsed.data.imu.size(), 1U);
    const ImuSample& sample = parsed.data.imu[0];
    EXPECT_EQ(sample.t, from_us(20));
    EXPECT_EQ(sample.acceleration_g, (std::array<float, 3>{1, -0.5, 0}));
    EXPECT_EQ(sample.gyro_dps, (std::array<float, 3>{10, -10, 2}));
    EXPECT_FLOAT_EQ(sample.temperature_c, 36);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat2, ImuSamplesThatMissWordsAreCounted) {
    const Parsed parsed =
        parse_whole(davis(), join({imu(0, 1, 20), imu(1, 1, 20), imu(6, 1, 20),  // holes
                                   imu(0, 1, 30), imu(1, 1, 30), imu(0, 1, 40),  // begun anew
                                   imu(1, 1, 40), imu(2, 1, 40), imu(4, 1, 40), imu(5, 1, 40),
                                   imu(6, 1, 40),  // without temperature
                                   imu(7, 1, 50), imu(0, 1, 60)}));
    EXPECT_EQ(parsed.data.imu.size(), 1U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 2U);
    EXPECT_EQ(parsed.damage[DamageReason::unknown_word], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U);
}

/// All resets, then all signals, as a global shutter reads.
Bytes global_frame(int x0, int y0, int width, int height, std::int64_t t) {
    Bytes all;
    for (const bool is_signal : {false, true})
        for (int x = x0; x < x0 + width; ++x)
            for (int y = y0; y < y0 + height; ++y) {
                const Bytes word = aps(is_signal, x, y, is_signal ? 500 - x - 10 * y : 600, t++, 4);
                all.insert(all.end(), word.begin(), word.end());
            }
    return all;
}

TEST(Aedat2, FramesAreTheDifferenceOfTwoReads) {
    const Parsed parsed = parse_whole(davis(3, 4), global_frame(0, 0, 3, 4, 100));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    const ReferenceImage& image = parsed.data.images[0];
    ASSERT_EQ(image.pixels.height(), 4);
    ASSERT_EQ(image.pixels.width(), 3);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 3; ++x) EXPECT_EQ(image.pixels(y, x), (100 + x + 10 * y) * 64);
    // 12 resets at 100..111, 12 signals at 112..123.
    EXPECT_EQ(image.exposure_begin, from_us(111));
    EXPECT_EQ(image.exposure_end, from_us(112));
    EXPECT_EQ(image.t, from_us(111));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat2, ARollingShutterExposesFromTheFirstReset) {
    // Columns 0, 1: reset 0, reset 1 while signal 0 is read, signal 1.
    const Parsed parsed =
        parse_whole(davis(2, 1), join({aps(false, 0, 0, 600, 10, 1), aps(true, 0, 0, 500, 30, 1),
                                       aps(false, 1, 0, 600, 31, 1), aps(true, 1, 0, 400, 50, 1)}));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.data.images[0].exposure_begin, from_us(10));
    EXPECT_EQ(parsed.data.images[0].exposure_end, from_us(30));
    EXPECT_EQ(parsed.data.images[0].t, from_us(20));
    EXPECT_EQ(parsed.data.images[0].pixels(0, 1), 200 * 64);
}

TEST(Aedat2, OverexposedPixelsAreWhite) {
    const Parsed parsed =
        parse_whole(davis(2, 1), join({aps(false, 0, 0, 100, 1, 1), aps(false, 1, 0, 600, 2, 1),
                                       aps(true, 0, 0, 90, 3, 1), aps(true, 1, 0, 0, 4, 1)}));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.data.images[0].pixels(0, 0), 1023 * 64);
    EXPECT_EQ(parsed.data.images[0].pixels(0, 1), 1023 * 64);
}

TEST(Aedat2, FramesOfARegionAreCompleteWhenTheyFillIt) {
    const Bytes one = global_frame(1, 1, 2, 3, 100), two = global_frame(1, 1, 2, 3, 200);
    const Parsed parsed = parse_whole(davis(5, 4), join({one, two}));
    ASSERT_EQ(parsed.data.images.size(), 2U);
    EXPECT_EQ(parsed.data.images[1].x0, 1);
    EXPECT_EQ(parsed.data.images[1].y0, 1);
    EXPECT_EQ(parsed.data.images[1].pixels.height(), 3);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat2, IncompleteFramesAreLeftOutAndCounted) {
    Bytes holed = global_frame(0, 0, 3, 4, 100);
    holed.erase(holed.begin() + 8 * 5, holed.begin() + 8 * 6);
    const Parsed parsed =
        parse_whole(davis(3, 4), join({holed, global_frame(0, 0, 3, 4, 200), holed}));
    EXPECT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U);
}

TEST(Aedat2, TimeGoesOnThroughWraps) {
    constexpr std::int64_t kHalf = std::int64_t(1) << 31;
    // Through 2^31 as an overflow to negative, through 2^32, and as a counter of 31 bits.
    for (const std::int64_t wrap : {kHalf, 2 * kHalf}) {
        const Parsed parsed =
            parse_whole(davis(), join({dvs(1, 1, true, wrap - 2), dvs(1, 1, true, wrap - 1),
                                       dvs(1, 1, true, wrap), dvs(1, 1, true, wrap + 5)}));
        ASSERT_EQ(parsed.data.events.size(), 4U);
        EXPECT_EQ((parsed.data.events[3].t - parsed.data.events[0].t).count(), 7);
        EXPECT_EQ(parsed.damage.total(), 0U);
    }
    const Parsed counter = parse_whole(
        davis(), join({dvs(1, 1, true, kHalf - 3), dvs(1, 1, true, 2), dvs(1, 1, true, 4)}));
    ASSERT_EQ(counter.data.events.size(), 3U);
    EXPECT_EQ(to_us(counter.data.events[1].t), kHalf + 2);
    EXPECT_EQ(to_us(counter.data.events[2].t), kHalf + 4);
}

TEST(Aedat2, AStepBackIsCountedAndAResetIsFollowed) {
    const Parsed back = parse_whole(
        davis(), join({dvs(1, 1, true, 100), dvs(1, 1, true, 90), dvs(1, 1, true, 110)}));
    EXPECT_EQ(back.data.events.size(), 2U);
    EXPECT_EQ(back.damage[DamageReason::time_backwards], 1U);

    std::vector<Bytes> words{dvs(1, 1, true, 5'000'000)};
    for (int i = 0; i < 100; ++i) words.push_back(dvs(1, 1, true, i * 1000));
    const Parsed reset = parse_whole(davis(), join(words));
    EXPECT_EQ(reset.damage[DamageReason::time_backwards],
              std::uint64_t(AedatTimeline::kResetRecords));
    EXPECT_EQ(reset.data.events.size(), 1U + 100 - AedatTimeline::kResetRecords);
    EXPECT_EQ(reset.data.triggers.size(), 1U);
    EXPECT_EQ(to_us(reset.data.events.back().t),
              5'000'000 + 1000 * (99 - AedatTimeline::kResetRecords));
}

TEST(Aedat2, AFlippedBitInATimeCostsOneRecord) {
    const Parsed parsed =
        parse_whole(davis(), join({dvs(1, 1, true, 100), dvs(1, 1, true, 110 | 1 << 29),
                                   dvs(1, 1, true, 120), dvs(1, 1, true, 130)}));
    EXPECT_EQ(parsed.data.events.size(), 3U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    EXPECT_EQ(parsed.clock, from_us(130));
}

/// A bit of everything, in time order.
Bytes mixture() {
    std::vector<Bytes> parts;
    for (const Event& e : random_events(3, 40, 5, 4, 50))
        parts.push_back(record(std::uint32_t(3 - e.y) << 22 | std::uint32_t(4 - e.x) << 12 |
                                   std::uint32_t(e.polarity == Polarity::on) << 11,
                               to_us(e.t)));
    parts.push_back(global_frame(0, 0, 5, 4, 2100));
    for (unsigned i = 0; i < 7; ++i) parts.push_back(imu(i, 100, 2200));
    parts.push_back(external(2300));
    for (const Event& e : random_events(4, 40, 5, 4, 2400))
        parts.push_back(
            record(std::uint32_t(3 - e.y) << 22 | std::uint32_t(4 - e.x) << 12, to_us(e.t)));
    return join(parts);
}

TEST(Aedat2, AnySplitCutOrDamageIsBorne) {
    const Bytes bytes = mixture();
    EXPECT_EQ(parse_whole(davis(5, 4), bytes).damage.total(), 0U);
    expect_same_for_any_split(davis(5, 4), bytes);
    expect_beginnings_for_any_cut(davis(5, 4), bytes);
    expect_bears_damage(davis(5, 4), bytes, 5, 4);
    expect_bears_damage(dvs128(), bytes, 128, 128);
}

std::string jaer_header(const std::string& chip) {
    return "#!AER-DAT2.0\r\n# This is a raw AE data file - do not edit\r\n# AEChip: " + chip +
           "\r\n#End Of ASCII Header\r\n";
}

TEST(Aedat2, TheChipIsReadFromTheHeader) {
    const auto size_of = [](const std::string& chip) {
        const StreamHeader h = read_aedat2_header(to_bytes(jaer_header(chip))).stream;
        return std::pair{h.width, h.height};
    };
    EXPECT_EQ(size_of("eu.seebetter.ini.chips.davis.DAVIS240C"), (std::pair{240, 180}));
    EXPECT_EQ(size_of("eu.seebetter.ini.chips.davis.Davis346B"), (std::pair{346, 260}));
    EXPECT_EQ(size_of("ch.unizh.ini.jaer.chip.retina.DVS128"), (std::pair{128, 128}));
    EXPECT_THROW(size_of("some.other.Chip"), Error);
}

TEST(Aedat2, DataThatBeginWithAHashAreNoHeader) {
    const std::string head = "#!AER-DAT2.0\r\n";
    Bytes bytes = to_bytes(head);
    const Bytes data = join({record(0x23202020, 5), record(0x0A0A0A0A, 6)});
    bytes.insert(bytes.end(), data.begin(), data.end());
    EXPECT_EQ(read_aedat2_header(bytes, 346, 260).stream.data_offset, head.size());
}

TEST(Aedat2, WithoutAChipShortAddressesMeanADvs128) {
    Bytes bytes = to_bytes("#!AER-DAT2.0\r\n");
    const Bytes data = join({record(0x7F01, 5), record(0x0102, 6)});
    bytes.insert(bytes.end(), data.begin(), data.end());
    EXPECT_EQ(read_aedat2_header(bytes).sensor, Aedat2Sensor::dvs128);
    const Bytes wide = record(0x12345678, 7);
    bytes.insert(bytes.end(), wide.begin(), wide.end());
    EXPECT_THROW(read_aedat2_header(bytes), Error);
    EXPECT_EQ(read_aedat2_header(bytes, 240, 180).sensor, Aedat2Sensor::davis);
}

Bytes aedat1_record(std::uint32_t address, std::int64_t t) {
    return join({big_endian(address, 2), big_endian(std::uint32_t(t), 4)});
}

TEST(Aedat1, SixByteRecordsOfADvs128) {
    const MakeParser make = [] { return std::make_unique<Aedat1Parser>(); };
    Bytes bytes;
    for (const Event& e : random_events(9, 60, 128, 128, 1000)) {
        const Bytes word =
            aedat1_record(std::uint32_t(127 - e.y) << 8 | std::uint32_t(127 - e.x) << 1 |
                              std::uint32_t(e.polarity == Polarity::off),
                          to_us(e.t));
        bytes.insert(bytes.end(), word.begin(), word.end());
    }
    const Parsed parsed = parse_whole(make, bytes);
    EXPECT_TRUE(parsed.data.events == random_events(9, 60, 128, 128, 1000));
    EXPECT_EQ(parsed.damage.total(), 0U);
    expect_same_for_any_split(make, bytes);
    expect_beginnings_for_any_cut(make, bytes);
    expect_bears_damage(make, bytes, 128, 128);
}

TEST(Aedat1, IsRecognisedWithAndWithoutItsVersion) {
    const Bytes data = aedat1_record(0x0102, 5);
    for (const char* head : {"#!AER-DAT1.0\r\n", "# This is a raw AE data file\r\n"}) {
        Bytes bytes = to_bytes(head);
        bytes.insert(bytes.end(), data.begin(), data.end());
        EXPECT_TRUE(looks_like_aedat1(bytes)) << head;
    }
    EXPECT_FALSE(looks_like_aedat1(to_bytes("# a comment\n0.1 2 3 0\n")));
    EXPECT_FALSE(looks_like_aedat1(to_bytes("#!AER-DAT2.0\r\n")));
    EXPECT_FALSE(looks_like_aedat1(data));
}

}  // namespace
}  // namespace eventide
