// Images in HDF5 recordings.
#include "replay/formats.h"
#include "replay/hdf5/hdf5_recording.h"
#include "replay/recording_file.h"
#include "tests/replay/hdf5_files.h"
#include "tests/replay/hdf5_layouts.h"
#include "tests/replay/recording_files.h"

#include <gmock/gmock.h>

namespace eventide {
namespace {

using test::Hdf5Made;

std::vector<std::uint8_t> pixels_of(int width, int height, int n) {
    std::vector<std::uint8_t> pixels;
    for (int i = 0; i < width * height; ++i) pixels.push_back(std::uint8_t(i * 7 + n));
    return pixels;
}

void expect_pixels(const ReferenceImage& image, int width, int height, int n) {
    ASSERT_EQ(image.pixels.width(), width);
    ASSERT_EQ(image.pixels.height(), height);
    const auto expected = pixels_of(width, height, n);
    for (std::size_t i = 0; i < expected.size(); ++i)
        ASSERT_EQ(image.pixels.values()[i], 257 * expected[i]);
}

TEST(Hdf5Images, OfMvsecComeWithTheEvents) {
    const TestFolder folder;
    const auto events = some_events(20'000, 1'000'000, 20, 346, 260);
    test::write_mvsec(folder.path("a.hdf5"), events);
    {
        const Hdf5Made file(folder.path("b.hdf5"));
        std::vector<std::uint8_t> pixels;
        for (int n = 0; n < 3; ++n)
            for (const std::uint8_t value : pixels_of(346, 260, n)) pixels.push_back(value);
        file.array("davis/left/image_raw", {3, 260, 346}, H5T_NATIVE_UINT8, pixels.data(),
                   H5T_STD_U8LE);
        file.column("davis/left/image_raw_ts", std::vector<double>{.9, 1.1, 1.15}, H5T_IEEE_F64LE,
                    0);
        const hid_t other = H5Fopen(folder.path("a.hdf5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
        H5Ocopy(other, "davis/left/events", file.id(), "davis/left/events", H5P_DEFAULT,
                H5P_DEFAULT);
        H5Fclose(other);
    }
    const auto recording = open_recording(folder.path("b.hdf5"));
    const Batch batch = read_everything(*recording);
    EXPECT_TRUE(batch.events == events);
    ASSERT_EQ(batch.images.size(), 3U);
    for (int n = 0; n < 3; ++n) expect_pixels(batch.images[std::size_t(n)], 346, 260, n);
    EXPECT_EQ(batch.images[1].t, from_us(1'100'000));
    recording->seek(from_us(1'120'000));
    EXPECT_EQ(read_everything(*recording).images.size(), 1U);
}

struct Shown {
    double t_s;
    int height = 2;  ///< px
};

/// DSEC's layout, of a sensor of 4x2 px: `events`, and images 4 px wide.
void write_with_images(const std::string& path, const std::vector<Event>& events,
                       const std::vector<Shown>& images) {
    const Hdf5Made file(path);
    const test::Columns columns(events);
    file.column("events/x", columns.x, H5T_STD_U16LE);
    file.column("events/y", columns.y, H5T_STD_U16LE);
    file.column("events/t", columns.t, H5T_STD_I64LE);
    file.column("events/p", columns.p, H5T_STD_U8LE);
    file.attribute("/", "sensor_resolution", std::vector<std::int64_t>{2, 4});
    for (std::size_t i = 0; i < images.size(); ++i) {
        const std::string name = "images/image" + std::to_string(100'000'000 + i);
        const int height = images[i].height;
        file.array(name, {hsize_t(height), 4}, H5T_NATIVE_UINT8,
                   pixels_of(4, height, int(i)).data(), H5T_STD_U8LE);
        file.attribute(name, "timestamp", std::vector{images[i].t_s});
    }
}

TEST(Hdf5Images, OneOfAnotherSizeIsDamage) {
    const TestFolder folder;
    write_with_images(folder.path("a.h5"), some_events(1000, 1'000'000, 20, 4, 2),
                      {{1}, {1.001, 3}, {1.002, 1}, {1.003}});
    const auto recording = open_recording(folder.path("a.h5"));
    const auto parser = recording->make_parser();
    Batch batch;
    RawPacket packet;
    while (recording->read(packet) == ReadStatus::data) parser->parse(packet.bytes, batch);
    ASSERT_EQ(batch.images.size(), 2U);
    expect_pixels(batch.images[1], 4, 2, 3);
    EXPECT_EQ(parser->damaged()[DamageReason::bad_record], 2U);
}

TEST(Hdf5Images, WhereEventsAreFewComeAFewAtATimeAndInTheirPlace) {
    const TestFolder folder;
    const std::vector<Event> events = some_events(30, 1'000'000, 2'000'000, 4, 2);
    std::vector<Shown> shown;
    for (int i = 0; i < 100; ++i) shown.push_back({.5 + .4 * i});
    write_with_images(folder.path("a.h5"), events, shown);
    const auto reader = open_hdf5(folder.path("a.h5"), {});
    Damage damage;
    std::vector<Event> read;
    std::vector<ReferenceImage> images;
    bool more = true;
    while (more) {
        Batch part;
        more = reader->read(part, damage);
        EXPECT_LE(part.images.size(), 8U);
        for (const ReferenceImage& image : part.images)
            EXPECT_TRUE(read.empty() || image.t >= read.back().t) << to_us(image.t);
        for (const Event& event : part.events)
            EXPECT_TRUE(images.empty() || event.t >= images.back().t);
        read.insert(read.end(), part.events.begin(), part.events.end());
        images.insert(images.end(), part.images.begin(), part.images.end());
    }
    EXPECT_TRUE(read == events);
    ASSERT_EQ(images.size(), 100U);
    for (int i = 0; i < 100; ++i) expect_pixels(images[std::size_t(i)], 4, 2, i);
    EXPECT_EQ(damage.total(), 0U);
}

TEST(Hdf5Images, OneWithAWrongTimeHoldsBackNoneBehindIt) {
    const TestFolder folder;
    const std::vector<Event> events = some_events(20'000, 1'000'000, 20, 4, 2);
    for (const double wrong_s : {-3600., 0., 3600.}) {
        write_with_images(folder.path("a.h5"), events, {{1.01}, {1.02}, {wrong_s}, {1.04}, {1.05}});
        const auto reader = open_hdf5(folder.path("a.h5"), {});
        Batch first;
        Damage damage;
        ASSERT_TRUE(reader->read(first, damage));
        ASSERT_EQ(first.images.size(), 5U) << wrong_s;
        EXPECT_EQ(first.images[4].t, from_us(1'050'000));
        EXPECT_EQ(first.images[2].t, from_us(std::int64_t(wrong_s * 1e6)));
        EXPECT_EQ(clock_at_end(*open_recording(folder.path("a.h5"))), events.back().t) << wrong_s;
    }
}

/// A file of a sensor of 32x24 px: a hundred events, which are given back, and `image` among them.
std::vector<Event> write_with_image(const std::string& path, ReferenceImage image) {
    StreamHeader header;
    header.width = 32;
    header.height = 24;
    Batch batch;
    batch.events = some_events(100, 3'000'000, 20, 32, 24);
    image.t = image.exposure_begin = image.exposure_end = batch.events[50].t;
    batch.images = {image};
    RecordingFile file(path, OutputOptions{}, *find_format("hdf5"), header);
    file.write(batch);
    file.finish();
    return batch.events;
}

TEST(Hdf5Images, OfAPartOfTheSensorAreWrittenAtTheirPlace) {
    const TestFolder folder;
    ReferenceImage part;
    part.x0 = 30;
    part.y0 = 5;
    part.pixels = Array2<std::uint16_t>(2, 4);
    for (std::size_t i = 0; i < 8; ++i) part.pixels.values()[i] = std::uint16_t(257 * (i + 1));
    write_with_image(folder.path("a.h5"), part);
    const auto images = read_everything(*open_recording(folder.path("a.h5"))).images;
    ASSERT_EQ(images.size(), 1U);
    Array2<std::uint16_t> expected(24, 32);
    expected(5, 30) = 257;
    expected(5, 31) = 2 * 257;
    expected(6, 30) = 5 * 257;
    expected(6, 31) = 6 * 257;
    EXPECT_TRUE(images[0].pixels == expected);
}

TEST(Hdf5Images, OfAnotherSizeThanTheSensorsAreLeftOutAndNamed) {
    const TestFolder folder;
    ReferenceImage image;
    image.pixels = Array2<std::uint16_t>(24, 32);
    const std::vector<Event> events = write_with_image(folder.path("a.h5"), image);
    OpenOptions stated;
    stated.width = 64;
    stated.height = 48;
    const auto recording = open_recording(folder.path("a.h5"), stated);
    EXPECT_THAT(recording->remarks(),
                testing::ElementsAre("the images are left out: they are 32x24 px, the events' "
                                     "sensor has 64x48"));
    const Batch read = read_everything(*recording);
    EXPECT_TRUE(read.events == events);
    EXPECT_TRUE(read.images.empty());
}

TEST(Hdf5Images, SurviveTheWayThroughDsecsLayout) {
    const TestFolder folder;
    StreamHeader header;
    header.width = 32;
    header.height = 24;
    header.sensor_name = "DAVIS346";
    header.serial = "00000042";
    Batch batch;
    batch.events = some_events(5'000, 3'000'000, 20, 32, 24);
    for (int n = 0; n < 3; ++n) {
        ReferenceImage image;
        image.t = image.exposure_begin = image.exposure_end =
            batch.events[std::size_t(1'000 * n + 500)].t;
        image.channels = n == 2 ? 3 : 1;
        image.pixels = Array2<std::uint16_t>(24, 32 * image.channels);
        for (std::size_t i = 0; i < image.pixels.values().size(); ++i)
            image.pixels.values()[i] = std::uint16_t(n == 1 ? i * 11 : i % 256 * 257);
        batch.images.push_back(image);
    }
    RecordingFile file(folder.path("a.h5"), OutputOptions{}, *find_format("hdf5"), header);
    file.write(batch);
    file.finish();
    EXPECT_EQ(file.bytes_written(), std::filesystem::file_size(folder.path("a.h5")));
    const auto recording = open_recording(folder.path("a.h5"));
    EXPECT_EQ(recording->info().name, "DAVIS346");
    EXPECT_EQ(recording->info().serial, "00000042");
    const Batch back = read_everything(*recording);
    EXPECT_TRUE(back.events == batch.events);
    EXPECT_TRUE(back.images == batch.images);
}

}  // namespace
}  // namespace eventide
