// AEDAT4: which of a file's streams are read.
#include "src/codec/aedat4/aedat4_flat_writer.h"
#include "src/core/error.h"
#include "tests/codec/aedat4_files.h"

#include <gtest/gtest.h>

#include <string>

namespace eventide {
namespace {

using namespace aedat4_files;

/// A node of outInfo.
std::string stream(int id, const std::string& identifier, const std::string& source,
                   const std::string& more = {}) {
    return "<node name=\"" + std::to_string(id) +
           "\"><attr key=\"typeIdentifier\" type=\"string\">" + identifier +
           "</attr><node name=\"info\"><attr key=\"source\" type=\"string\">" + source + "</attr>" +
           more + "</node></node>\n";
}
std::string size(int width, int height) {
    return "<attr key=\"sizeX\" type=\"int\">" + std::to_string(width) +
           "</attr><attr key=\"sizeY\" type=\"int\">" + std::to_string(height) + "</attr>";
}

Bytes header_of(const std::string& streams) {
    FlatWriter flat("IOHE", {4, 8, 4});
    flat.set(flat.root(), 1, std::int64_t{-1});
    flat.set_text(flat.root(), 2,
                  "<dv version=\"2.0\"><node name=\"other\"><attr key=\"x\">1</attr>"
                  "<node name=\"empty\"/></node>"
                  "<node name=\"outInfo\">" +
                      streams + "</node></dv>");
    Bytes bytes = to_bytes("#!AER-DAT4.0\r\n");
    const auto packed = flat.bytes();
    bytes.insert(bytes.end(), packed.begin(), packed.end());
    return bytes;
}

/// The packets of a batch, as these streams.
Bytes packets(const Batch& batch, const std::vector<int>& ids) {
    const Bytes file = write_file({batch}, Aedat4Compression::none, false);
    Bytes data = split_file(file).data;
    for (std::size_t at = 0; at < data.size();) {
        const auto id = load_little<std::uint32_t>(data.data() + at);
        const std::size_t bytes = 8 + load_little<std::uint32_t>(data.data() + at + 4);
        data[at] = std::byte(ids[id]);
        at += bytes;
    }
    return data;
}

Bytes operator+(Bytes a, const Bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

Batch events_and_an_image(unsigned seed, std::int64_t first_us) {
    Batch batch;
    batch.events = random_events(seed, 100, 240, 180, first_us);
    ReferenceImage image;
    image.t = image.exposure_begin = image.exposure_end = batch.events.front().t;
    image.pixels = Array2<std::uint16_t>(4, 3);
    image.pixels.values()[0] = std::uint16_t(257 * seed);
    batch.images = {image};
    batch.imu = {{image.t, {float(seed), 0, 0}, {}, {}, 20}};
    batch.triggers = {{image.t, Trigger::Kind::rising, 0}};
    return batch;
}

/// Of a DAVIS240, whose events are stream 3, and a DVXplorer, whose events are stream 7.
Bytes two_cameras(const Batch& a, const Batch& b) {
    return header_of(stream(0, "FRME", "DVXplorer_B_7", size(640, 480)) +
                     stream(1, "IMUS", "DVXplorer_B_7") + stream(2, "TRIG", "DVXplorer_B_7") +
                     stream(3, "EVTS", "DAVIS240C_A_5",
                            size(240, 180) + "<node name=\"deeper\">" + size(9, 9) + "</node>") +
                     stream(4, "FRME", "DAVIS240C_A_5",
                            "<attr key=\"colorFilter\">2</attr>" + size(240, 180)) +
                     stream(5, "IMUS", "DAVIS240C_A_5") + stream(6, "TRIG", "DAVIS240C_A_5") +
                     stream(7, "EVTS", "DVXplorer_B_7", size(640, 480))) +
           packets(b, {7, 0, 1, 2}) + packets(a, {3, 4, 5, 6});
}

TEST(Aedat4Streams, OfTwoCamerasTheOneOfTheFirstEventsIsRead) {
    const Batch a = events_and_an_image(1, 1'000'000), b = events_and_an_image(2, 1'000'500);
    const Bytes file = two_cameras(a, b);
    const Aedat4Header header = read_aedat4_header(file);
    EXPECT_EQ(header.stream.sensor_name, "DAVIS240C_A");
    EXPECT_EQ(header.stream.serial, "5");
    EXPECT_EQ(header.stream.width, 240);
    EXPECT_EQ(header.stream.height, 180);
    EXPECT_EQ(header.stream.colour_filter, ColourFilter::grbg);
    EXPECT_EQ(header.streams.size(), 8U);
    const Parsed parsed = parse_file(file);
    EXPECT_TRUE(parsed.data.events == a.events);
    EXPECT_TRUE(parsed.data.images == a.images);
    EXPECT_TRUE(parsed.data.imu == a.imu);
    EXPECT_TRUE(parsed.data.triggers == a.triggers);
}

TEST(Aedat4Streams, OfTwoCamerasTheOneThatIsWantedIsRead) {
    const Batch a = events_and_an_image(1, 1'000'000), b = events_and_an_image(2, 1'000'500);
    const Bytes file = two_cameras(a, b);
    const Aedat4Header header = read_aedat4_header(file, "7");
    EXPECT_EQ(header.stream.sensor_name, "DVXplorer_B");
    EXPECT_EQ(header.stream.width, 640);
    const Parsed parsed =
        parse_whole([&] { return std::make_unique<Aedat4Parser>(header, 640, 480); },
                    std::span(file).subspan(header.stream.data_offset));
    EXPECT_TRUE(parsed.data.events == b.events);
    EXPECT_TRUE(parsed.data.images == b.images);
    EXPECT_TRUE(parsed.data.imu == b.imu);
    EXPECT_TRUE(parsed.data.triggers == b.triggers);
    for (const char* none : {"4", "8", "07", "DAVIS240C_A_5"}) {
        try {
            read_aedat4_header(file, none);
            FAIL() << none;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_EQ(std::string(error.what()),
                      "AEDAT4 header: expected an event stream " + std::string(none) +
                          ", found 3 (DAVIS240C_A_5), 7 (DVXplorer_B_7)");
        }
    }
}

TEST(Aedat4Streams, WhereTheHeaderNamesNoneTheFirstOfEachKindIsRead) {
    const Batch a = events_and_an_image(1, 1'000'000), b = events_and_an_image(2, 1'010'000),
                c = events_and_an_image(3, 1'020'000);
    const Bytes data =
        packets(a, {3, 4, 5, 6}) + packets(b, {13, 14, 15, 16}) + packets(c, {3, 4, 5, 6});
    Aedat4Header header;
    header.stream.data_offset = 100;
    const Parsed parsed =
        parse_whole([&] { return std::make_unique<Aedat4Parser>(header, kWidth, kHeight); }, data);
    auto events = a.events;
    events.insert(events.end(), c.events.begin(), c.events.end());
    EXPECT_TRUE(parsed.data.events == events);
    EXPECT_EQ(parsed.data.images, (std::vector{a.images[0], c.images[0]}));
    EXPECT_EQ(parsed.data.imu, (std::vector{a.imu[0], c.imu[0]}));
    EXPECT_EQ(parsed.data.triggers, (std::vector{a.triggers[0], c.triggers[0]}));
}

TEST(Aedat4Streams, ATableOfOtherPacketsIsCountedAndNotNeeded) {
    const auto events = random_events(6, 300, kWidth, kHeight);
    for (const std::size_t packets_told : {3U, 2U}) {
        const File file = split_file(write_file(in_packets(events, 3), Aedat4Compression::none));
        const Bytes other = write_file(in_packets(events, packets_told), Aedat4Compression::none);
        const auto table = std::size_t(read_aedat4_header(other).table_position);
        Bytes data(file.data.begin(),
                   file.data.begin() + std::ptrdiff_t(std::size_t(file.header.table_position) -
                                                      file.header.stream.data_offset));
        data.insert(data.end(), other.begin() + std::ptrdiff_t(table), other.end());
        const Parsed parsed = parse_whole(file.make(), data);
        EXPECT_TRUE(parsed.data.events == events);
        EXPECT_EQ(parsed.damage[DamageReason::bad_table], packets_told == 3 ? 0U : 1U);
        EXPECT_EQ(parsed.damage.total(), packets_told == 3 ? 0U : 1U);
    }
}

}  // namespace
}  // namespace eventide
