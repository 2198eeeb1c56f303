// AEDAT4: real files, the writer's files, and read(write(x)) = x. Damage: test_aedat4_damage.cpp.
#include "src/core/error.h"
#include "tests/codec/aedat4_files.h"
#include "tests/codec/data_files.h"

#include <cmath>
#include <string>

namespace eventide {
namespace {

using namespace aedat4_files;

class EachCompression : public testing::TestWithParam<Aedat4Compression> {};

TEST_P(EachCompression, WhatIsWrittenIsReadBack) {
    const Batch batch = some_of_everything();
    const Bytes bytes = write_file({batch}, GetParam());
    const Parsed parsed = parse_file(bytes);
    EXPECT_TRUE(parsed.data.events == batch.events);
    EXPECT_TRUE(parsed.data.images == batch.images);
    EXPECT_TRUE(parsed.data.imu == batch.imu);
    EXPECT_TRUE(parsed.data.triggers == batch.triggers);
    EXPECT_EQ(parsed.damage.total(), 0U);
    const Aedat4Header header = read_aedat4_header(bytes);
    EXPECT_EQ(header.stream.width, kWidth);
    EXPECT_EQ(header.stream.height, kHeight);
    EXPECT_EQ(header.stream.sensor_name, "DAVIS346");
    EXPECT_EQ(header.stream.serial, "00000104");
    EXPECT_EQ(header.streams.size(), 4U);
}

TEST_P(EachCompression, AnySplitGivesTheSame) {
    const File file = split_file(write_file({some_of_everything()}, GetParam()));
    expect_same_for_any_split(file.make(), file.data);
}

TEST_P(EachCompression, FlippedBitsAreBorne) {
    const File file = split_file(write_file({some_of_everything(1)}, GetParam()));
    expect_bears_damage(file.make(), file.data, kWidth, kHeight, 40);
}

INSTANTIATE_TEST_SUITE_P(Aedat4, EachCompression,
                         testing::Values(Aedat4Compression::none, Aedat4Compression::lz4,
                                         Aedat4Compression::lz4_high, Aedat4Compression::zstd,
                                         Aedat4Compression::zstd_high));

TEST(Aedat4, RealRecordingsGiveTheirNumbers) {
    struct Expected {
        const char* name;
        std::size_t events, on, frames, imu, triggers;
        std::int64_t first, last;
    };
    for (const Expected& expected : {Expected{"davis346_robotarm.aedat4", 117667, 72363, 3, 130, 15,
                                              1633953690975950, 1633953691105949},
                                     Expected{"davis346_desk.aedat4", 6676, 3563, 4, 160, 17,
                                              1589163147368868, 1589163147538809}}) {
        SCOPED_TRACE(expected.name);
        const Bytes file = read_data_file(expected.name);
        if (file.empty()) GTEST_SKIP() << "no shared/data/formats";
        const Parsed parsed = parse_file(file);
        const auto& events = parsed.data.events;
        EXPECT_EQ(events.size(), expected.events);
        EXPECT_EQ(count_on(events), expected.on);
        EXPECT_EQ(to_us(events.front().t), expected.first);
        EXPECT_EQ(to_us(events.back().t), expected.last);
        EXPECT_EQ(parsed.data.images.size(), expected.frames);
        EXPECT_EQ(parsed.data.imu.size(), expected.imu);
        EXPECT_EQ(parsed.data.triggers.size(), expected.triggers);
        EXPECT_EQ(parsed.damage.total(), 0U);
        const ReferenceImage& image = parsed.data.images.front();
        EXPECT_EQ(image.pixels.width(), kWidth);
        EXPECT_EQ(image.pixels.height(), kHeight);
        EXPECT_LT(image.exposure_begin, image.t);
        EXPECT_LT(image.t, image.exposure_end);
        // At rest a camera feels the earth: 1 g.
        const auto& g = parsed.data.imu.front().acceleration_g;
        EXPECT_NEAR(std::hypot(g[0], g[1], g[2]), 1, .1);
    }
}

TEST(Aedat4, ARealRecordingWrittenAnewIsTheSame) {
    const Bytes file = read_data_file("davis346_robotarm.aedat4");
    if (file.empty()) GTEST_SKIP() << "no shared/data/formats";
    const Parsed parsed = parse_file(file);
    const Parsed again = parse_file(write_file({parsed.data}, Aedat4Compression::lz4));
    expect_same(parsed, again, "written anew");
}

TEST(Aedat4, TheTableLeadsToATime) {
    const auto events = random_events(6, 400, kWidth, kHeight);
    const std::vector<Batch> batches = in_packets(events, 4);
    for (const bool with_end : {true, false}) {
        const Bytes bytes = write_file(batches, Aedat4Compression::lz4, with_end);
        const Aedat4Header header = read_aedat4_header(bytes);
        const auto read_at = [&](std::uint64_t position, std::span<std::byte> into) {
            const auto rest =
                std::span(bytes).subspan(std::min(bytes.size(), std::size_t(position)));
            const std::size_t n = std::min(rest.size(), into.size());
            std::copy_n(rest.begin(), n, into.begin());
            return n;
        };
        // The last of a packet is still in it.
        for (const auto& [wanted, first] : {std::pair{250U, 200U}, std::pair{199U, 100U}}) {
            const auto position = find_in_aedat4_table(header, read_at, events[wanted].t);
            EXPECT_EQ(position.has_value(), with_end);
            if (!position) continue;
            Aedat4Parser parser(header, kWidth, kHeight);
            parser.resync();
            Batch batch;
            parser.parse(std::span(bytes).subspan(std::size_t(*position)), batch);
            ASSERT_FALSE(batch.events.empty());
            EXPECT_TRUE(batch.events.front() == events[first]);
        }
    }
}

TEST(Aedat4, BehindAResetThatATriggerTellsTimeBeginsAnew) {
    const auto after = random_events(2, 500, kWidth, kHeight, 1'000);
    struct Case {
        std::int64_t first_us;
        bool told;
    };
    for (const auto& [first_us, told] :
         {Case{60'000'000, true}, Case{60'000'000, false}, Case{500'000, true}}) {
        const auto before = random_events(1, 500, kWidth, kHeight, first_us);
        auto all = before;
        all.insert(all.end(), after.begin(), after.end());
        auto packets = in_packets(all, 1);
        packets.emplace_back();  // as --record has it: with events from before and behind
        packets[1].events.assign(all.begin() + 100, all.end());
        if (told) packets[1].triggers = {{after.front().t, Trigger::Kind::timestamp_reset, 0}};
        const Parsed parsed = parse_file(write_file(packets, Aedat4Compression::lz4));
        EXPECT_TRUE(parsed.data.events == (told ? all : before));
        EXPECT_EQ(parsed.damage[DamageReason::time_backwards], told ? 0U : after.size());
        EXPECT_EQ(parsed.clock, told ? after.back().t : before.back().t);
    }
}

TEST(Aedat4, WhereTimeGoesOnBehindAResetAnEventInThePastIsDamage) {
    auto packets = in_packets(random_events(1, 100, kWidth, kHeight, 60'000'000), 1);
    packets[0].triggers = {{packets[0].events[50].t, Trigger::Kind::timestamp_reset, 0}};
    auto later = random_events(2, 200, kWidth, kHeight, 61'500'000);
    later[150].t = from_us(61'200'000);
    for (const Batch& packet : in_packets(later, 2)) packets.push_back(packet);
    const Parsed parsed = parse_file(write_file(packets, Aedat4Compression::lz4));
    EXPECT_EQ(parsed.data.events.size(), 299U);
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 1U);
}

/// Seconds may pass behind a reset before anything moves.
TEST(Aedat4, ALateFirstEventBehindAResetBeginsAnewWhereItIsFarInThePast) {
    for (const std::int64_t late_us : {3'000'000, 59'500'000}) {
        const auto before = random_events(1, 100, kWidth, kHeight, 60'000'000);
        const auto after = random_events(2, 100, kWidth, kHeight, late_us);
        std::vector<Batch> packets = in_packets(before, 1);
        packets.emplace_back().triggers = {{from_us(1'000), Trigger::Kind::timestamp_reset, 0}};
        packets.push_back(in_packets(after, 1)[0]);
        const Parsed parsed = parse_file(write_file(packets, Aedat4Compression::lz4));
        const bool is_far = late_us < 59'000'000;
        EXPECT_EQ(parsed.data.events.size(), is_far ? 200U : 100U);
        EXPECT_EQ(parsed.damage[DamageReason::time_backwards], is_far ? 0U : 100U);
    }
}

TEST(Aedat4, AnExposureMayBeginAtZero) {
    Batch batch;
    ReferenceImage image;
    image.exposure_end = from_us(500);
    image.t = from_us(250);
    image.pixels = Array2<std::uint16_t>(2, 2);
    batch.images = {image};
    EXPECT_TRUE(parse_file(write_file({batch}, Aedat4Compression::none)).data.images ==
                batch.images);
}

TEST(Aedat4, TheStreamsOfAHeaderAreFoundInItsText) {
    const auto streams = read_aedat4_streams(
        "<dv><node name=\"outInfo\">"
        "<node name=\"0\"><attr key=\"typeIdentifier\" type=\"string\">FRME</attr>"
        "<node name=\"info\"><attr key=\"source\">B_2</attr></node></node>"
        "<node name=\"1\"><attr key=\"typeIdentifier\" type=\"string\">EVTS</attr>"
        "<node name=\"info\"><attr key=\"sizeX\">240</attr><attr "
        "key=\"source\">A_1</attr></node></node>"
        "</node></dv>");
    ASSERT_EQ(streams.size(), 2U);
    EXPECT_EQ(streams[1].id, 1);
    EXPECT_EQ(streams[1].width, 240);
    EXPECT_EQ(streams[0].source, "B_2");
}

TEST(Aedat4, WhatItCannotHoldIsRefusedByName) {
    const auto refuses = [](const Batch& batch, const char* word) {
        Aedat4Writer writer;
        Bytes out;
        writer.begin({}, out);
        try {
            writer.write(batch, out);
            ADD_FAILURE() << word;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        }
    };
    Batch event, trigger;
    event.events = {{from_us(0), 40000, 0, Polarity::on}};
    trigger.triggers = {{from_us(0), Trigger::Kind::rising, 7}};
    refuses(event, "40000");
    refuses(trigger, "source 7");
    Batch mark;
    for (const int source : {9, 128}) {
        mark.triggers = {{from_us(0), Trigger::Kind::other, std::uint8_t(source)}};
        refuses(mark, "source");
    }
    mark.triggers = {{from_us(0), Trigger::Kind::other, 10},
                     {from_us(0), Trigger::Kind::other, 127}};
    EXPECT_TRUE(parse_file(write_file({mark}, Aedat4Compression::none)).data.triggers ==
                mark.triggers);
}

}  // namespace
}  // namespace eventide
