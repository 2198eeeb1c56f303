// MVSEC's layout, written here as its authors describe it: what is read is what was written.
#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/evreal_sequence.h"
#include "src/core/error.h"
#include "tests/apps/evaluate/small_model.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>

#include <algorithm>
#include <vector>

namespace eventide {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 36, kHeight = 28;
constexpr double kBegin = 1504645177.42;  // s: the days MVSEC was recorded

/// What a file holds; each test changes what it is about.
struct Mvsec {
    std::vector<double> events;  ///< x, y, t, p
    std::vector<double> image_times;
    std::vector<std::int64_t> image_events;
    std::vector<std::uint8_t> images;
};

/// An event each `step_s`, an image each `image_s` from half of it on, for `span_s`.
Mvsec small_file(double span_s, double step_s, double image_s) {
    Mvsec file;
    for (int i = 0; i * step_s < span_s; ++i)
        file.events.insert(file.events.end(), {double(i * 7 % kWidth), double(i * 5 % kHeight),
                                               kBegin + i * step_s, i % 2 == 0 ? 1. : -1.});
    for (int i = 0; (i + .5) * image_s < span_s; ++i) {
        const double t = (i + .5) * image_s;
        file.image_times.push_back(kBegin + t);
        file.image_events.push_back(std::int64_t(t / step_s + 1e-6));
        for (int p = 0; p < kWidth * kHeight; ++p)
            file.images.push_back(std::uint8_t((p + 10 * i) % 256));
    }
    return file;
}

void write(hid_t group, const char* name, const std::vector<hsize_t>& shape, hid_t kind,
           const void* values) {
    const hid_t space = H5Screate_simple(int(shape.size()), shape.data(), nullptr);
    const hid_t set = H5Dcreate2(group, name, kind, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(H5Dwrite(set, kind, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0) << name;
    H5Dclose(set);
    H5Sclose(space);
}

/// Without `left_out`.
fs::path write_file(const std::string& name, const Mvsec& content,
                    const std::string& left_out = {}) {
    const fs::path folder = fs::path{testing::TempDir()} / ("eventide_mvsec_" + name);
    fs::remove_all(folder);
    fs::create_directories(folder);
    const fs::path path = folder / "indoor_flying4_data.hdf5";
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t davis = H5Gcreate2(file, "davis", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t left = H5Gcreate2(davis, "left", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const hsize_t images = content.image_times.size();
    if (left_out != "events")
        write(left, "events", {content.events.size() / 4, 4}, H5T_NATIVE_DOUBLE,
              content.events.data());
    write(left, "image_raw", {images, kHeight, kWidth}, H5T_NATIVE_UINT8, content.images.data());
    write(left, "image_raw_ts", {images}, H5T_NATIVE_DOUBLE, content.image_times.data());
    write(left, "image_raw_event_inds", {content.image_events.size()}, H5T_NATIVE_INT64,
          content.image_events.data());
    H5Gclose(left);
    H5Gclose(davis);
    H5Fclose(file);
    return path;
}

std::string refusal_of(const fs::path& path) {
    try {
        read_evreal_sequence(path, {}, {});
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
    ADD_FAILURE() << "was taken";
    return {};
}

SensorTime after_begin(std::int64_t us) {
    return from_us(std::llround(kBegin * 1e6) + us);
}

TEST(MvsecFile, GivesEventsAndImagesAndTheFirstTime) {
    const fs::path path = write_file("whole", small_file(.5, .001, .1));
    const ReferenceSequence sequence = read_evreal_sequence(path, {}, {});
    EXPECT_EQ(sequence.width, kWidth);
    EXPECT_EQ(sequence.height, kHeight);
    ASSERT_EQ(sequence.events.size(), 500U);
    ASSERT_EQ(sequence.images.size(), 5U);
    EXPECT_EQ(sequence.first, after_begin(0));
    EXPECT_EQ(sequence.events[0], (Event{after_begin(0), 0, 0, Polarity::on}));
    EXPECT_EQ(sequence.events[3], (Event{after_begin(3000), 21, 15, Polarity::off}));
    EXPECT_EQ(sequence.images[1].t, after_begin(150'000));
    EXPECT_EQ(sequence.damaged.total(), 0U);
    EXPECT_EQ(sequence.images[1].pixels(0, 3), 13 * 257);
}

TEST(MvsecFile, GivesThePartThatWasAskedFor) {
    const fs::path path = write_file("part", small_file(.5, .001, .1));
    const ReferenceSequence part = read_evreal_sequence(path, .1, .3);
    EXPECT_EQ(part.events.front().t, after_begin(100'000));
    EXPECT_EQ(part.events.back().t, after_begin(300'000));
    EXPECT_EQ(part.images.size(), 2U);
    EXPECT_TRUE(read_evreal_sequence(path, 7, 8).images.empty());
}

TEST(MvsecFile, IsASequenceOfTheEvrealProtocolWithItsCut) {
    const fs::path path = write_file("protocol", small_file(21, .01, 1));
    const EvaluateReport report = evaluate_evreal(path.parent_path(), small_model());
    ASSERT_EQ(report.sequences.size(), 1U);
    EXPECT_EQ(report.overall.frames, 10);  // of 21 those from 10 to 19.8 s
    EXPECT_NEAR(report.sequences[0].frames.front().time_s, 10.5, 1e-5);
}

TEST(MvsecFile, WhatIsMissingIsNamed) {
    const Mvsec content = small_file(.5, .001, .1);
    EXPECT_NE(refusal_of(write_file("no_events", content, "events")).find("davis/left/events"),
              std::string::npos);
    Mvsec no_images = content;
    no_images.image_times.clear();
    no_images.images.clear();
    no_images.image_events.clear();
    EXPECT_NE(refusal_of(write_file("no_images", no_images)).find("expected reference images"),
              std::string::npos);
}

TEST(MvsecFile, WhatIsLeftOutIsToldInTheReport) {
    Mvsec content = small_file(21, .01, 1);
    content.events[4 * 30 + 2] = std::nan("");
    const EvaluateReport report = evaluate_evreal(write_file("damaged", content), small_model());
    ASSERT_FALSE(report.notes.empty());
    EXPECT_NE(report.notes.front().find("damaged: bad_record 1"), std::string::npos)
        << report.notes.front();
}

}  // namespace
}  // namespace eventide
