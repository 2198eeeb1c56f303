// AEDAT 3.1: what is written is read back.
#include "src/codec/aedat/aedat3_records.h"
#include "src/codec/aedat4/aedat4_records.h"
#include "src/core/error.h"
#include "tests/codec/aedat3_words.h"

namespace eventide::aedat3 {
namespace {

TEST(Aedat3, AResetIsReadBackAsItWasWritten) {
    Batch batch;
    batch.events = random_events(1, 5000, kWidth, kHeight, 60'000'000);
    const auto behind = random_events(2, 5000, kWidth, kHeight, 1'000);
    batch.events.insert(batch.events.end(), behind.begin(), behind.end());
    batch.triggers = {{behind.front().t, Trigger::Kind::timestamp_reset, 0}};
    Bytes bytes;
    Aedat3Writer().write(batch, bytes);
    const Parsed parsed = parse_whole(make_parser(), bytes);
    EXPECT_TRUE(parsed.data.events == batch.events);
    EXPECT_TRUE(parsed.data.triggers == batch.triggers);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat3, TheGeneratorIsTheSameInAedat4AndNoInputIsTakenForIt) {
    const auto in_aedat4 = [](Aedat3Special number) {
        return aedat4_trigger_number(*read_special(1U | std::uint32_t(number) << 1));
    };
    EXPECT_EQ(in_aedat4(Aedat3Special::generator_rising), 4);
    EXPECT_EQ(in_aedat4(Aedat3Special::generator_falling), 5);
    EXPECT_EQ(in_aedat4(Aedat3Special::rising), 1);
    for (const Aedat3Special of_others :
         {Aedat3Special::rising_1, Aedat3Special::falling_1, Aedat3Special::pulse_1,
          Aedat3Special::rising_2, Aedat3Special::falling_2, Aedat3Special::pulse_2})
        EXPECT_EQ(in_aedat4(of_others), -1) << int(of_others);
}

TEST(Aedat3, WhatIsWrittenIsReadBack) {
    constexpr std::int64_t kOverflow = std::int64_t(1) << 31;
    for (const std::int64_t first : {std::int64_t(0), kOverflow - 300, 5 * kOverflow - 9000,
                                     std::int64_t(1'633'953'690'975'950)}) {
        StreamHeader stream;
        stream.width = kWidth;
        stream.height = kHeight;
        stream.sensor_name = "a camera";
        Aedat3Writer writer;
        Bytes bytes;
        writer.begin(stream, bytes);
        const Batch one = everything(1, first), two = everything(2, first + 20000);
        writer.write(one, bytes);
        writer.write(two, bytes);
        writer.finish(bytes);

        const Aedat3Header header = read_aedat3_header(bytes);
        EXPECT_EQ(header.stream.width, kWidth);
        EXPECT_EQ(header.stream.height, kHeight);
        EXPECT_EQ(header.stream.sensor_name, "a camera");
        const Parsed parsed =
            parse_whole([&] { return std::make_unique<Aedat3Parser>(header, kWidth, kHeight); },
                        std::span(bytes).subspan(header.stream.data_offset));
        const auto joined = [](auto a, const auto& b) {
            a.insert(a.end(), b.begin(), b.end());
            return a;
        };
        EXPECT_TRUE(parsed.data.events == joined(one.events, two.events)) << first;
        EXPECT_TRUE(parsed.data.images == joined(one.images, two.images)) << first;
        EXPECT_TRUE(parsed.data.imu == joined(one.imu, two.imu)) << first;
        EXPECT_TRUE(parsed.data.triggers == joined(one.triggers, two.triggers)) << first;
        EXPECT_EQ(parsed.damage.total(), 0U) << first;
    }
}

TEST(Aedat3, WhatTheFormatCannotHoldIsRefused) {
    Bytes bytes;
    Batch negative, wide;
    negative.events = {{from_us(-1), 0, 0, Polarity::on}};
    wide.events = {{from_us(1), 40000, 0, Polarity::on}};
    EXPECT_THROW(Aedat3Writer().write(negative, bytes), Error);
    EXPECT_THROW(Aedat3Writer().write(wide, bytes), Error);
}

}  // namespace
}  // namespace eventide::aedat3
