// What the AEDAT4 writer writes, read and verified by the flatbuffers library itself; and what that
// library writes, read by ours.
#include "src/codec/aedat4/aedat4.h"
#include "src/codec/aedat4/aedat4_writer.h"
#include "src/core/byte_order.h"
#include "tests/codec/parser_checks.h"

#include <aedat4_generated.h>

#include <string>

namespace eventide {
namespace {

/// Strict: every offset, every alignment, the identifier. The bytes have to stay aligned.
template <typename T>
const T* verified(const Bytes& bytes, const char* identifier) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(bytes.data());
    flatbuffers::Verifier verifier(begin, bytes.size());
    if (!verifier.VerifySizePrefixedBuffer<T>(identifier)) return nullptr;
    return flatbuffers::GetSizePrefixedRoot<T>(begin);
}

struct Written {
    Bytes header, table;
    std::vector<Bytes> packets;
    std::vector<std::int32_t> streams;
    std::vector<std::int64_t> offsets;  ///< of the payloads
    std::int64_t table_offset = 0;
};

Written write(const Batch& batch) {
    Aedat4Writer writer(Aedat4Compression::none);
    StreamHeader header;
    header.width = 346;
    header.height = 260;
    Bytes file;
    writer.begin(header, file);
    writer.write(batch, file);
    const std::size_t end = file.size();
    writer.finish(file);
    for (const auto& patch : writer.patches())
        std::copy(patch.bytes.begin(), patch.bytes.end(),
                  file.begin() + std::ptrdiff_t(patch.offset));
    Written written;
    const std::size_t magic = kAedat4Magic.size();
    std::size_t at = magic + 4 + load_little<std::uint32_t>(file.data() + magic);
    const auto piece = [&](std::size_t from, std::size_t to) {
        return Bytes(file.begin() + std::ptrdiff_t(from), file.begin() + std::ptrdiff_t(to));
    };
    written.header = piece(magic, at);
    while (at < end) {
        const std::size_t size = load_little<std::uint32_t>(file.data() + at + 4);
        written.streams.push_back(load_little<std::int32_t>(file.data() + at));
        written.offsets.push_back(std::int64_t(at + 8));
        written.packets.push_back(piece(at + 8, at + 8 + size));
        at += 8 + size;
    }
    written.table_offset = std::int64_t(end);
    written.table = piece(end, file.size());
    return written;
}

constexpr std::int64_t kBegin = 1'600'000'000'000'000;  // us

Batch one_of_each() {
    const auto at = [](std::int64_t us) { return from_us(kBegin + us); };
    Batch batch;
    batch.events = random_events(1, 100, 346, 260, kBegin);
    batch.imu = {{at(5), {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, 10}, {at(6), {-1, -2, -3}, {}, {}, 0}};
    batch.triggers = {{at(7), Trigger::Kind::rising, 0}, {at(8), Trigger::Kind::exposure_end, 0}};
    ReferenceImage image{at(50), at(40), at(61), 3, 4, 1, {}};
    image.pixels = Array2<std::uint16_t>(5, 7);
    image.pixels(4, 6) = 200 * 257;
    batch.images = {image};
    return batch;
}

TEST(Aedat4Strict, EveryPacketIsAsTheLibraryWantsIt) {
    const Batch batch = one_of_each();
    const Written written = write(batch);
    ASSERT_EQ(written.packets.size(), 4U);
    const std::vector<std::int32_t> streams{3, 0, 1, 2};
    EXPECT_EQ(written.streams, streams);

    const auto* triggers = verified<strict::TriggerPacket>(written.packets[0], "TRIG");
    ASSERT_TRUE(triggers);
    ASSERT_EQ(triggers->elements()->size(), 2U);
    EXPECT_EQ(triggers->elements()->Get(1)->timestamp(), kBegin + 8);
    EXPECT_EQ(triggers->elements()->Get(1)->type(), 9);

    const auto* events = verified<strict::EventPacket>(written.packets[1], "EVTS");
    ASSERT_TRUE(events);
    ASSERT_EQ(events->elements()->size(), 100U);
    for (unsigned i = 0; i < 100; ++i) {
        EXPECT_EQ(events->elements()->Get(i)->timestamp(), to_us(batch.events[i].t));
        EXPECT_EQ(events->elements()->Get(i)->x(), batch.events[i].x);
        EXPECT_EQ(events->elements()->Get(i)->polarity(), batch.events[i].polarity == Polarity::on);
    }

    const auto* frame = verified<strict::Frame>(written.packets[2], "FRME");
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->timestamp(), kBegin + 50);
    EXPECT_EQ(frame->timestamp_start_of_exposure(), kBegin + 40);
    EXPECT_EQ(frame->timestamp_end_of_exposure(), kBegin + 61);
    EXPECT_EQ(frame->exposure(), 21);
    EXPECT_EQ(frame->format(), 0);
    EXPECT_EQ(frame->size_x(), 7);
    EXPECT_EQ(frame->size_y(), 5);
    EXPECT_EQ(frame->position_x(), 3);
    ASSERT_EQ(frame->pixels()->size(), 35U);
    EXPECT_EQ(frame->pixels()->Get(34), 200);

    const auto* imu = verified<strict::ImuPacket>(written.packets[3], "IMUS");
    ASSERT_TRUE(imu);
    EXPECT_EQ(imu->elements()->Get(0)->gyroscope_z(), 6);
    EXPECT_EQ(imu->elements()->Get(0)->magnetometer_x(), 7);
    EXPECT_EQ(imu->elements()->Get(1)->accelerometer_y(), -2);
}

TEST(Aedat4Strict, HeaderAndTableAreAsTheLibraryWantsThem) {
    const Written written = write(one_of_each());
    const auto* header = verified<strict::IoHeader>(written.header, "IOHE");
    ASSERT_TRUE(header);
    EXPECT_EQ(header->data_table_position(), written.table_offset);
    EXPECT_NE(header->info_node()->str().find("<node name=\"outInfo\""), std::string::npos);

    const auto* table = verified<strict::FileDataTable>(written.table, "FTAB");
    ASSERT_TRUE(table);
    ASSERT_EQ(table->table()->size(), written.packets.size());
    for (unsigned i = 0; i < table->table()->size(); ++i) {
        const auto* entry = table->table()->Get(i);
        EXPECT_EQ(entry->byte_offset(), written.offsets[i]);
        EXPECT_EQ(entry->packet_info()->stream_id(), written.streams[i]);
        EXPECT_EQ(std::size_t(entry->packet_info()->size()), written.packets[i].size());
        EXPECT_LE(entry->timestamp_start(), entry->timestamp_end());
        EXPECT_GT(entry->num_elements(), 0);
    }
}

/// Builds with the library, whose buffers are laid out back to front.
TEST(Aedat4Strict, WhatTheLibraryWritesIsRead) {
    flatbuffers::FlatBufferBuilder events, frame;
    std::vector<strict::Event> elements;
    for (int i = 0; i < 10; ++i)
        elements.emplace_back(1000 + i, std::int16_t(i), std::int16_t(2), true);
    events.FinishSizePrefixed(
        strict::CreateEventPacket(events, events.CreateVectorOfStructs(elements)), "EVTS");
    // A newer recorder: the stamp is the begin of the exposure; 16 bits per pixel.
    const std::vector<std::uint8_t> pixels{0x34, 0x12, 0xFF, 0xFF};
    const auto vector = frame.CreateVector(pixels);
    frame.FinishSizePrefixed(
        strict::CreateFrame(frame, 5000, 0, 0, 0, 0, 2, 2, 1, 0, 0, vector, 300), "FRME");

    Bytes stream;
    std::int32_t id = 0;
    for (const auto* builder : {&events, &frame}) {
        append_little(stream, id++);
        append_little(stream, std::int32_t(builder->GetSize()));
        const auto* begin = reinterpret_cast<const std::byte*>(builder->GetBufferPointer());
        stream.insert(stream.end(), begin, begin + builder->GetSize());
    }
    const auto make = [] { return std::make_unique<Aedat4Parser>(Aedat4Header{}, 346, 260); };
    const Parsed parsed = parse_whole(make, stream);
    ASSERT_EQ(parsed.data.events.size(), 10U);
    EXPECT_EQ(to_us(parsed.data.events[9].t), 1009);
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(to_us(parsed.data.images[0].t), 5150);
    EXPECT_EQ(to_us(parsed.data.images[0].exposure_begin), 5000);
    EXPECT_EQ(to_us(parsed.data.images[0].exposure_end), 5300);
    EXPECT_EQ(parsed.data.images[0].pixels(0, 0), 0x1234);
    EXPECT_EQ(parsed.damage[DamageReason::bad_table], 1U);
    EXPECT_EQ(parsed.damage.total(), 1U);
}

}  // namespace
}  // namespace eventide
