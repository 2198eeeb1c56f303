// AEDAT4 files that are cut, spoiled or lie: what can be saved is, the rest is counted by reason.
#include "src/codec/aedat4/aedat4_flat_writer.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "tests/codec/aedat4_files.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace eventide {
namespace {

using namespace aedat4_files;

TEST(Aedat4Damage, ACutGivesABeginning) {
    const std::vector<Batch> batches = in_packets(some_of_everything().events, 3);
    const File file = split_file(write_file(batches, Aedat4Compression::lz4));
    expect_beginnings_for_any_cut(file.make(), file.data);
    const Parsed cut = parse_whole(file.make(), std::span(file.data).first(file.data.size() / 3));
    EXPECT_EQ(cut.damage[DamageReason::truncated], 1U);
}

TEST(Aedat4Damage, AMissingTableIsCountedAndNotNeeded) {
    const Batch batch = some_of_everything();
    const Parsed parsed = parse_file(write_file({batch}, Aedat4Compression::lz4, false));
    EXPECT_TRUE(parsed.data.events == batch.events);
    EXPECT_EQ(parsed.damage[DamageReason::bad_table], 1U);
    EXPECT_EQ(parsed.damage.total(), 1U);
}

TEST(Aedat4Damage, ADamagedTableIsCountedAndNotNeeded) {
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

TEST(Aedat4Damage, ATableIsUnpackedToNoMoreThanAPacket) {
    const Batch batch = some_of_everything();
    Bytes file = write_file({batch}, Aedat4Compression::none);
    const Aedat4Header header = read_aedat4_header(file);
    Bytes table(file.begin() + header.table_position, file.end());
    constexpr std::size_t kMore = 1 << 20;
    table.insert(table.end(), kMore, std::byte{0});
    const std::uint32_t size = std::uint32_t(table.size() - 4);
    for (std::size_t i = 0; i < 4; ++i) table[i] = std::byte(size >> (8 * i) & 0xFF);
    file.resize(std::size_t(header.table_position));
    pack_aedat4(table, Aedat4Compression::zstd, file);
    const auto bytes = std::span<const std::byte>(file).subspan(header.stream.data_offset);
    for (const auto& [largest, damaged] : {std::pair{kMore, 1U}, {4 * kMore, 0U}}) {
        Aedat4Parser parser{header, kWidth, kHeight, largest};
        Batch parsed;
        parser.parse(bytes, parsed);
        parser.finish(parsed);
        EXPECT_EQ(parser.damaged()[DamageReason::bad_table], damaged) << largest;
    }
}

TEST(Aedat4Damage, APacketThatDoesNotUnpackCostsOnlyItself) {
    const auto events = random_events(3, 300, kWidth, kHeight);
    const std::vector<Batch> batches = in_packets(events, 3);
    for (const auto compression : {Aedat4Compression::lz4, Aedat4Compression::zstd}) {
        File file = split_file(write_file(batches, compression));
        const std::size_t first = 8 + load_little<std::uint32_t>(file.data.data() + 4);
        for (std::size_t i = 20; i < 60; ++i) file.data[first + i] = std::byte{0xFF};
        const Parsed parsed = parse_whole(file.make(), file.data);
        EXPECT_EQ(parsed.data.events.size(), 200U);
        EXPECT_EQ(parsed.damage.total(), 1U);
    }
}

TEST(Aedat4Damage, ASizeThatLiesDoesNotSwallowWhatFollows) {
    const auto events = random_events(4, 500, kWidth, kHeight);
    const std::vector<Batch> batches = in_packets(events, 5);
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

TEST(Aedat4Damage, ASizeThatTakesInWholePacketsCostsOnlyItsOwn) {
    const auto events = random_events(4, 500, kWidth, kHeight);
    const std::vector<Batch> batches = in_packets(events, 5);
    for (const auto compression : {Aedat4Compression::lz4, Aedat4Compression::zstd}) {
        File file = split_file(write_file(batches, compression));
        const auto size_at = [&](std::size_t at) {
            return load_little<std::uint32_t>(file.data.data() + at + 4);
        };
        const std::size_t first = 8 + size_at(0), second = first + 8 + size_at(first);
        const auto lie = std::uint32_t(second + size_at(second));  // to the end of the third
        for (std::size_t i = 0; i < 4; ++i) file.data[4 + i] = std::byte(lie >> (8 * i) & 0xFF);
        const Parsed parsed = parse_whole(file.make(), file.data);
        EXPECT_TRUE(std::equal(parsed.data.events.begin(), parsed.data.events.end(),
                               events.begin() + 100, events.end()));
        EXPECT_EQ(parsed.damage[DamageReason::bad_compression], 1U);
    }
}

TEST(Aedat4Damage, EventsOutsideAndBackInTimeAreLeftOut) {
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
TEST(Aedat4Damage, APacketWhoseTimesLeapCostsWhatLeaptAndNothingThatFollows) {
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

TEST(Aedat4Damage, AnImageSampleOrTriggerWithATimeOfItsOwnIsNoSilence) {
    const auto events = random_events(1, 400, kWidth, kHeight, 1'600'000'000'000'000);
    const std::int64_t end = to_us(events.back().t), far = end + 3'600'000'000;
    ReferenceImage image;
    image.pixels = Array2<std::uint16_t>(2, 3);
    using Put = std::function<void(Batch&, SensorTime)>;
    for (const Put& put : {Put([&](Batch&batch, SensorTime t) {
                               image.t = image.exposure_begin = image.exposure_end = t;
                               batch.images.push_back(image);
                           }),
                           Put([](Batch&batch, SensorTime t) {
                               batch.imu.push_back({t, {}, {}, {}, 0});
                           }),
                           Put([](Batch&batch, SensorTime t) {
                               batch.triggers.push_back({t, Trigger::Kind::rising, 0});
                           })}) {
        const auto clock_of = [&](std::int64_t first_us, std::int64_t second_us) {
            auto batches = in_packets(events, 4);
            put(batches[1], from_us(first_us));
            put(batches[3], from_us(second_us));
            return parse_file(write_file(batches, Aedat4Compression::none)).clock;
        };
        EXPECT_EQ(clock_of(far, end + 40'000), from_us(end + 40'000));
        EXPECT_EQ(clock_of(far, far + 40'000), from_us(far + 40'000));
    }
}

TEST(Aedat4Damage, AFirstTimeOfZeroBeforeTimesSince1970IsLeftOut) {
    Batch batch;
    batch.events = random_events(5, 1000, kWidth, kHeight, 1'600'000'000'000'000);
    std::vector<Event> expected = batch.events;
    batch.events.insert(batch.events.begin(), {from_us(0), 1, 1, Polarity::on});
    for (const bool one_packet : {true, false}) {
        std::vector<Batch> packets{batch};
        if (!one_packet) {
            packets.assign(2, {});
            packets[0].events.assign(batch.events.begin(), batch.events.begin() + 1);
            packets[1].events.assign(batch.events.begin() + 1, batch.events.end());
        }
        const Parsed parsed = parse_file(write_file(packets, Aedat4Compression::none));
        EXPECT_TRUE(parsed.data.events == expected) << one_packet;
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    }
}

TEST(Aedat4Damage, SilenceBetweenPacketsIsNoDamage) {
    Batch before, after;
    before.events = random_events(5, 1000, kWidth, kHeight, 1'600'000'000'000'000);
    after.events = random_events(6, 1000, kWidth, kHeight, 1'600'000'900'000'000);
    const Parsed parsed = parse_file(write_file({before, after}, Aedat4Compression::lz4));
    EXPECT_EQ(parsed.data.events.size(), 2000U);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat4Damage, ReadingTakesUpAtTheNextPacketAfterALoss) {
    const auto events = random_events(5, 400, kWidth, kHeight);
    const std::vector<Batch> batches = in_packets(events, 4);
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

TEST(Aedat4Damage, HeadersThatLieAreRefused) {
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

}  // namespace
}  // namespace eventide
