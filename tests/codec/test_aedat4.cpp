// AEDAT4: real files, the writer's files, and all sorts of damage.
#include "src/codec/aedat4.h"

#include "src/codec/aedat4_flat_writer.h"
#include "src/codec/aedat4_writer.h"
#include "src/codec/byte_order.h"
#include "src/core/error.h"
#include "tests/codec/data_files.h"
#include "tests/codec/parser_checks.h"

#include <cmath>
#include <string>

namespace eventide {
namespace {

constexpr int kWidth = 346, kHeight = 260;

/// Parses what follows the header, as replay does.
Parsed parse_file(const Bytes& file) {
    const Aedat4Header header = read_aedat4_header(file);
    const auto make = [&] {
        return std::make_unique<Aedat4Parser>(header, header.stream.width, header.stream.height);
    };
    return parse_whole(make, std::span(file).subspan(header.stream.data_offset));
}

struct File {
    Aedat4Header header;
    Bytes data;  ///< after the header
    MakeParser make() const {
        return
            [header = header] { return std::make_unique<Aedat4Parser>(header, kWidth, kHeight); };
    }
};

Batch some_of_everything(unsigned seed = 1) {
    Batch batch;
    batch.events = random_events(seed, 3000, kWidth, kHeight, 1'600'000'000'000'000);
    const SensorTime t = batch.events.front().t;
    for (int i = 0; i < 4; ++i) {
        const int channels = i == 2 ? 3 : i == 3 ? 4 : 1;
        ReferenceImage image{t + SensorDuration(1000 * i), {}, {}, 2, 3, channels, {}};
        image.exposure_begin = image.t - SensorDuration(i == 0 ? 0 : 50);
        image.exposure_end = image.t + SensorDuration(i == 0 ? 0 : 51);
        image.pixels = Array2<std::uint16_t>(11, 20 * channels);
        unsigned value = 0;
        for (std::uint16_t& pixel : image.pixels.values())
            pixel = std::uint16_t(i == 1 ? (value += 77) : 257 * (++value % 256));  // 16 and 8 bits
        batch.images.push_back(image);
    }
    for (int i = 0; i < 5; ++i)
        batch.imu.push_back(
            {t + SensorDuration(i), {1.5F, -2, float(i)}, {300, -1, 0}, {1, 2, 3}, 36});
    using Kind = Trigger::Kind;
    for (const Kind kind :
         {Kind::timestamp_reset, Kind::rising, Kind::falling, Kind::pulse, Kind::frame_begin,
          Kind::frame_end, Kind::exposure_begin, Kind::exposure_end})
        batch.triggers.push_back({t + SensorDuration(int(kind)), kind, 0});
    batch.triggers.push_back({t + SensorDuration(20), Kind::rising, 1});
    batch.triggers.push_back({t + SensorDuration(20), Kind::falling, 1});
    batch.triggers.push_back({t + SensorDuration(21), Kind::other, 99});
    return batch;
}

Bytes write_file(const std::vector<Batch>& batches, Aedat4Compression compression,
                 bool with_end = true) {
    Aedat4Writer writer(compression);
    StreamHeader header;
    header.width = kWidth;
    header.height = kHeight;
    header.sensor_name = "DAVIS346";
    header.serial = "00000104";
    Bytes out;
    writer.begin(header, out);
    for (const Batch& batch : batches) writer.write(batch, out);
    if (!with_end) return out;
    writer.finish(out);
    for (const auto& patch : writer.patches())
        std::copy(patch.bytes.begin(), patch.bytes.end(),
                  out.begin() + std::ptrdiff_t(patch.offset));
    return out;
}

File split_file(const Bytes& bytes) {
    File file{read_aedat4_header(bytes), {}};
    file.data.assign(bytes.begin() + std::ptrdiff_t(file.header.stream.data_offset), bytes.end());
    return file;
}

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

TEST(Aedat4, ACutGivesABeginning) {
    Batch batch = some_of_everything();
    std::vector<Batch> batches(3);
    for (std::size_t i = 0; i < 3; ++i)
        batches[i].events.assign(batch.events.begin() + std::ptrdiff_t(100 * i),
                                 batch.events.begin() + std::ptrdiff_t(100 * (i + 1)));
    const File file = split_file(write_file(batches, Aedat4Compression::lz4));
    expect_beginnings_for_any_cut(file.make(), file.data);
    const Parsed cut = parse_whole(file.make(), std::span(file.data).first(file.data.size() / 3));
    EXPECT_EQ(cut.damage[DamageReason::truncated], 1U);
}

TEST(Aedat4, AMissingTableIsCountedAndNotNeeded) {
    const Batch batch = some_of_everything();
    const Parsed parsed = parse_file(write_file({batch}, Aedat4Compression::lz4, false));
    EXPECT_TRUE(parsed.data.events == batch.events);
    EXPECT_EQ(parsed.damage[DamageReason::bad_table], 1U);
    EXPECT_EQ(parsed.damage.total(), 1U);
}

TEST(Aedat4, ADamagedTableIsCountedAndNotNeeded) {
    const Batch batch = some_of_everything();
    const Bytes whole = write_file({batch}, Aedat4Compression::none);
    const auto position = read_aedat4_header(whole).table_position;
    for (const std::size_t into : {8U, 14U, 40U}) {
        Bytes file = whole;
        for (std::size_t i = 0; i < 4; ++i)
            file[std::size_t(position) + into + i] ^= std::byte{0x5A};
        const Parsed parsed = parse_file(file);
        EXPECT_TRUE(parsed.data.events == batch.events);
        EXPECT_GE(parsed.damage.total(), 1U) << into;
    }
}

TEST(Aedat4, APacketThatDoesNotUnpackCostsOnlyItself) {
    std::vector<Batch> batches(3);
    const auto events = random_events(3, 300, kWidth, kHeight);
    for (std::size_t i = 0; i < 3; ++i)
        batches[i].events.assign(events.begin() + std::ptrdiff_t(100 * i),
                                 events.begin() + std::ptrdiff_t(100 * (i + 1)));
    for (const auto compression : {Aedat4Compression::lz4, Aedat4Compression::zstd}) {
        File file = split_file(write_file(batches, compression));
        const std::size_t first = 8 + load_little<std::uint32_t>(file.data.data() + 4);
        for (std::size_t i = 20; i < 60; ++i) file.data[first + i] = std::byte{0xFF};
        const Parsed parsed = parse_whole(file.make(), file.data);
        EXPECT_EQ(parsed.data.events.size(), 200U);
        EXPECT_EQ(parsed.damage.total(), 1U);
    }
}

TEST(Aedat4, ASizeThatLiesDoesNotSwallowWhatFollows) {
    std::vector<Batch> batches(5);
    const auto events = random_events(4, 500, kWidth, kHeight);
    for (std::size_t i = 0; i < 5; ++i)
        batches[i].events.assign(events.begin() + std::ptrdiff_t(100 * i),
                                 events.begin() + std::ptrdiff_t(100 * (i + 1)));
    for (const std::uint32_t lie : {0x7FFFFFFFU, 0x0FFFFFFFU, 0U, 3U, 0xFFFFFFFFU}) {
        File file = split_file(write_file(batches, Aedat4Compression::lz4));
        const std::size_t first = 8 + load_little<std::uint32_t>(file.data.data() + 4);
        for (std::size_t i = 0; i < 4; ++i)
            file.data[first + 4 + i] = std::byte(lie >> (8 * i) & 0xFF);
        const Parsed parsed = parse_whole(file.make(), file.data);
        EXPECT_GE(parsed.data.events.size(), 400U) << lie;
        EXPECT_GE(parsed.damage.total(), 1U) << lie;
    }
}

TEST(Aedat4, EventsOutsideAndBackInTimeAreLeftOut) {
    Batch batch;
    batch.events = {{from_us(1000), 1, 2, Polarity::on},
                    {from_us(1001), kWidth, 2, Polarity::on},
                    {from_us(1002), 1, kHeight, Polarity::on},
                    {from_us(999), 1, 2, Polarity::on},
                    {from_us(1003), 3, 4, Polarity::off}};
    const Parsed parsed = parse_file(write_file({batch}, Aedat4Compression::lz4));
    const std::vector<Event> expected{batch.events[0], batch.events[4]};
    EXPECT_TRUE(parsed.data.events == expected);
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 2U);
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 1U);
}

// A flipped bit in a packed time is repeated in all times that were packed by reference to it.
TEST(Aedat4, APacketWhoseTimesLeapCostsWhatLeaptAndNothingThatFollows) {
    const auto events = random_events(5, 3000, kWidth, kHeight, 1'600'000'000'000'000);
    const std::vector<std::ptrdiff_t> ends{0, 1000, 2000, 3000};
    std::vector<Batch> packets(3);
    for (std::size_t i = 0; i < 3; ++i)
        packets[i].events.assign(events.begin() + ends[i], events.begin() + ends[i + 1]);
    constexpr std::size_t kWhole = 400;
    for (std::size_t i = kWhole; i < 1000; ++i)
        packets[1].events[i].t += SensorDuration(std::int64_t{1} << 33);
    const Parsed parsed = parse_file(write_file(packets, Aedat4Compression::none));
    std::vector<Event> expected(events.begin(), events.begin() + 1000 + kWhole);
    expected.insert(expected.end(), events.begin() + 2000, events.end());
    EXPECT_TRUE(parsed.data.events == expected);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1000 - kWhole);
    EXPECT_EQ(parsed.damage.total(), 1000 - kWhole);
}

TEST(Aedat4, SilenceBetweenPacketsIsNoDamage) {
    Batch before, after;
    before.events = random_events(5, 1000, kWidth, kHeight, 1'600'000'000'000'000);
    after.events = random_events(6, 1000, kWidth, kHeight, 1'600'000'900'000'000);
    const Parsed parsed = parse_file(write_file({before, after}, Aedat4Compression::lz4));
    EXPECT_EQ(parsed.data.events.size(), 2000U);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat4, ReadingTakesUpAtTheNextPacketAfterALoss) {
    std::vector<Batch> batches(4);
    const auto events = random_events(5, 400, kWidth, kHeight);
    for (std::size_t i = 0; i < 4; ++i)
        batches[i].events.assign(events.begin() + std::ptrdiff_t(100 * i),
                                 events.begin() + std::ptrdiff_t(100 * (i + 1)));
    const File file = split_file(write_file(batches, Aedat4Compression::lz4));
    const std::size_t first = 8 + load_little<std::uint32_t>(file.data.data() + 4);
    for (const std::size_t from : {std::size_t(1), first - 1, first}) {
        const auto parser = file.make()();
        parser->resync();
        Batch batch;
        parser->parse(std::span(file.data).subspan(from), batch);
        parser->finish(batch);
        EXPECT_TRUE(std::equal(batch.events.begin(), batch.events.end(), events.begin() + 100,
                               events.end()));
        EXPECT_EQ(parser->damaged().total(), 0U);
    }
}

TEST(Aedat4, TheTableLeadsToATime) {
    std::vector<Batch> batches(4);
    const auto events = random_events(6, 400, kWidth, kHeight);
    for (std::size_t i = 0; i < 4; ++i)
        batches[i].events.assign(events.begin() + std::ptrdiff_t(100 * i),
                                 events.begin() + std::ptrdiff_t(100 * (i + 1)));
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
        const auto position = find_in_aedat4_table(header, read_at, events[250].t);
        EXPECT_EQ(position.has_value(), with_end);
        if (!position) continue;
        Aedat4Parser parser(header, kWidth, kHeight);
        parser.resync();
        Batch batch;
        parser.parse(std::span(bytes).subspan(std::size_t(*position)), batch);
        ASSERT_FALSE(batch.events.empty());
        EXPECT_TRUE(batch.events.front() == events[200]);
    }
}

TEST(Aedat4, HeadersThatLieAreRefused) {
    const Bytes whole = write_file({}, Aedat4Compression::lz4);
    for (std::size_t n = 0; n < 200; ++n)
        EXPECT_THROW(read_aedat4_header(std::span(whole).first(n)), Error) << n;
    for (unsigned seed = 0; seed < 2000; ++seed) {
        std::mt19937 random(seed);
        Bytes damaged = whole;
        for (int i = 0; i < 3; ++i)
            damaged[14 + random() % (damaged.size() - 14)] = std::byte(random() & 0xFF);
        try {
            read_aedat4_header(damaged);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
        }
    }
}

TEST(Aedat4, OfTwoCamerasTheFirstIsRead) {
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
}

}  // namespace
}  // namespace eventide
