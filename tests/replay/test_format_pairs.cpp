// From each format to each other: what both hold is as it was, and the rest is counted.
#include "replay/convert.h"

#include "src/core/whole_sensor.h"
#include "tests/replay/recording_files.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace eventide {
namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr std::int64_t kSince1970 = 1'633'953'690'975'950;

/// Each pixel a value of 16 bits, or of 8.
ReferenceImage image_of(int width, int height, int channels, std::uint16_t unit) {
    ReferenceImage image;
    image.channels = channels;
    image.pixels = Array2<std::uint16_t>(height, width * channels);
    std::uint16_t value = 0;
    for (std::uint16_t& pixel : image.pixels.values()) pixel = std::uint16_t(value++ % 200 * unit);
    return image;
}

/// Some of all that a sensor says, with images grey and in colour, of 8 and 16 bits, and of a part.
Batch everything() {
    Batch batch;
    batch.events = some_events(3'000, kSince1970, 20, kWidth, kHeight);
    const auto at = [&](std::size_t i) { return batch.events[500 * i].t; };
    batch.images = {image_of(kWidth, kHeight, 1, 257), image_of(32, 16, 1, 300),
                    image_of(kWidth, kHeight, 3, 257)};
    batch.images[1].x0 = 8;
    batch.images[1].y0 = 4;
    for (std::size_t i = 0; i < batch.images.size(); ++i) {
        batch.images[i].t = at(i + 1);
        batch.images[i].exposure_begin = at(i + 1) - SensorDuration{500};
        batch.images[i].exposure_end = at(i + 1) + SensorDuration{500};
    }
    batch.imu = {{at(1), {.5F, -1, .25F}, {100, -20, 3}, {}, 30},
                 {at(2), {0, 0, 1}, {1, 2, 3}, {4, 5, 6}, 31}};
    using Kind = Trigger::Kind;
    batch.triggers = {{at(1), Kind::rising, 0},
                      {at(2), Kind::falling, 0},
                      {at(3), Kind::rising, 2},
                      {at(4), Kind::falling, Trigger::kGenerator},
                      {at(5), Kind::exposure_end, 0}};
    return batch;
}

/// What is left in a file of the format.
std::pair<Batch, DataCounts> held(Batch batch, const Format& format) {
    const DataCounts left_out = remove_not_held(batch, format.holds);
    if (format.name != "hdf5") return {batch, left_out};
    for (ReferenceImage& image : batch.images) {
        if (!covers_sensor(image, kWidth, kHeight)) image = on_whole_sensor(image, kWidth, kHeight);
        image.exposure_begin = image.exposure_end = image.t;
    }
    return {batch, left_out};
}

void expect_same(const Batch& found, const Batch& expected) {
    EXPECT_TRUE(found.events == expected.events);
    EXPECT_TRUE(found.images == expected.images);
    EXPECT_TRUE(found.imu == expected.imu);
    EXPECT_TRUE(found.triggers == expected.triggers);
}

TEST(FormatPairs, WhatBothHoldIsAsItWasAndTheRestIsCounted) {
    const TestFolder folder;
    for (const Format& first : all_formats()) {
        if (!first.is_written()) continue;
        const std::string from = folder.path("a" + std::string(first.extension));
        {
            Batch batch = everything();
            remove_not_held(batch, first.holds);
            StreamHeader header;
            header.format = first.name;
            header.width = kWidth;
            header.height = kHeight;
            RecordingFile file{from, {.overwrite = true}, first, header};
            file.write(batch);
            file.finish();
        }
        const Batch there = held(everything(), first).first;
        expect_same(read_everything(*open_recording(from)), there);
        for (const Format& second : all_formats()) {
            if (!second.is_written()) continue;
            SCOPED_TRACE(std::string(first.name) + " to " + std::string(second.name));
            const std::string to = folder.path("b" + std::string(second.extension));
            const auto report = convert(*open_recording(from), to, second, {.overwrite = true});
            const auto [expected, left_out] = held(there, second);
            expect_same(read_everything(*open_recording(to)), expected);
            EXPECT_EQ(report.data.left_out(), left_out);
            EXPECT_EQ(report.damaged.total(), 0U);
        }
    }
}

}  // namespace
}  // namespace eventide
