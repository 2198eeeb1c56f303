// HDF5 recordings that eventide writes.
#include "replay/formats.h"
#include "replay/recording_file.h"
#include "src/core/error.h"
#include "src/io/file_lock.h"
#include "tests/replay/hdf5_files.h"
#include "tests/replay/hdf5_layouts.h"
#include "tests/replay/recording_files.h"
#include "tests/support/error_of.h"

#include <gmock/gmock.h>

#include <fcntl.h>
#include <unistd.h>

namespace eventide {
namespace {

TEST(Hdf5Writing, KeepsDsecsPromisesOfItsIndex) {
    const TestFolder folder;
    const auto events = some_events(200'000, 7'000'123, 300, 640, 480);
    test::write_hdf5(folder.path("a.h5"), events);
    const hid_t file = H5Fopen(folder.path("a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const auto read = [&](const char* name) {
        const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(set);
        std::vector<std::int64_t> values(std::size_t(H5Sget_simple_extent_npoints(space)));
        H5Dread(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        H5Sclose(space);
        H5Dclose(set);
        return values;
    };
    const auto t = read("events/t"), index = read("ms_to_idx");
    EXPECT_EQ(read("t_offset"), std::vector<std::int64_t>{to_us(events[0].t)});
    H5Fclose(file);
    ASSERT_EQ(t.size(), events.size());
    ASSERT_EQ(std::int64_t(index.size()), t.back() / 1000 + 1);
    for (std::size_t ms = 0; ms < index.size(); ++ms) {
        const auto row = std::size_t(index[ms]);
        ASSERT_GE(t[row], std::int64_t(ms) * 1000);
        if (row > 0) {
            ASSERT_LT(t[row - 1], std::int64_t(ms) * 1000);
        }
    }
}

TEST(Hdf5Writing, AnImageBeforeAllEventsBelongsToTheFirst) {
    const TestFolder folder;
    StreamHeader header;
    header.width = header.height = 128;
    RecordingFile writer(folder.path("a.h5"), OutputOptions{}, *find_format("hdf5"), header);
    ReferenceImage image;
    image.pixels = Array2<std::uint16_t>(128, 128);
    Batch before, behind;
    before.images = {image};
    behind.events = some_events(10);
    writer.write(before);
    writer.write(behind);
    writer.finish();
    const hid_t file = H5Fopen(folder.path("a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t attribute =
        H5Aopen_by_name(file, "images/image000000000", "event_idx", H5P_DEFAULT, H5P_DEFAULT);
    std::int64_t event = -7;
    EXPECT_GE(H5Aread(attribute, H5T_NATIVE_INT64, &event), 0);
    EXPECT_EQ(event, 0);
    H5Aclose(attribute);
    H5Fclose(file);
}

TEST(Hdf5Writing, LeavesNothingBehindWhereItFails) {
    const TestFolder folder;
    const std::string precious = folder.write("a.h5", "precious");
    StreamHeader header;
    header.width = header.height = 128;
    EXPECT_THROW(RecordingFile(precious, OutputOptions{}, *find_format("hdf5"), header), Error);
    EXPECT_EQ(read_text(precious), "precious");
    {
        RecordingFile file(precious, OutputOptions{.overwrite = true}, *find_format("hdf5"),
                           header);
        Batch batch;
        batch.events = {{from_us(0), 1, 2, Polarity::on},
                        {from_us(8LL * 86400 * 1'000'000), 1, 2, Polarity::on}};
        EXPECT_THROW(file.write(batch), Error);  // beyond what the index may span
    }
    EXPECT_EQ(read_text(precious), "precious");
    EXPECT_EQ(
        std::distance(
            std::filesystem::directory_iterator(std::filesystem::path(precious).parent_path()), {}),
        1);
    EXPECT_THROW(
        RecordingFile("/dev/null", OutputOptions{.overwrite = true}, *find_format("hdf5"), header),
        Error);
}

TEST(Hdf5Writing, GrowsUnderItsNameWhereThatIsAskedFor) {
    const TestFolder folder;
    StreamHeader header;
    header.width = header.height = 128;
    const auto events = some_events(3'000);
    RecordingFile file(folder.path("a.h5"), OutputOptions{.appears = Appears::growing},
                       *find_format("hdf5"), header);
    Batch batch;
    batch.events = events;
    file.write(batch);
    file.finish();
    EXPECT_TRUE(read_everything(*open_recording(folder.path("a.h5"))).events == events);
}

TEST(Hdf5Writing, OneThatAnotherProgramWritesIsNotSaidToBeDamaged) {
    const TestFolder folder;
    const std::string file = folder.path("a.h5");
    test::write_hdf5(file, some_events(10));
    const int writer = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_TRUE(lock_file(writer));  // as HDF5 itself does
    EXPECT_THAT(test::error_of([&] { open_recording(file); }, ErrorKind::input),
                testing::HasSubstr("found one that another program has locked"));
    ::close(writer);
    EXPECT_NO_THROW(open_recording(file));
}

TEST(Hdf5Writing, WhatAKilledRunHasWrittenCanBeReadButForTheLastSecond) {
    const TestFolder folder;
    StreamHeader header;
    header.width = header.height = 128;
    RecordingFile file(folder.path("a.h5"), OutputOptions{.appears = Appears::growing},
                       *find_format("hdf5"), header);
    const auto events = some_events(100'000, 7'000'000, 100);  // 5 s
    for (std::size_t i = 0; i < events.size(); i += 500) {
        Batch batch;
        batch.events.assign(events.begin() + std::ptrdiff_t(i),
                            events.begin() + std::ptrdiff_t(i + 500));
        if (i % 10'000 == 0) {
            batch.images.emplace_back().pixels = Array2<std::uint16_t>(128, 128);
            batch.images[0].t = batch.events[0].t;
        }
        file.write(batch);
    }
    // What is on the disk now is what a killed program leaves; this one has the file open.
    std::filesystem::copy_file(folder.path("a.h5"), folder.path("killed.h5"));
    const auto left = open_recording(folder.path("killed.h5"));
    const Batch found = read_everything(*left);
    ASSERT_GT(found.events.size(), 0U);
    EXPECT_GE(found.events.back().t, events.back().t - std::chrono::seconds{1});
    EXPECT_TRUE(std::ranges::equal(found.events, std::span{events}.first(found.events.size())));
    EXPECT_GE(found.images.size(), 8U);
    const SensorTime middle = found.events[found.events.size() / 2].t;
    left->seek(middle);
    EXPECT_LE(read_everything(*left).events.front().t, middle);
}

}  // namespace
}  // namespace eventide
