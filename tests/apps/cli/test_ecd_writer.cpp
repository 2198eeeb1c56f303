// A folder of the Event Camera Dataset: what is written is read back.
#include "apps/cli/commands/ecd_writer.h"
#include "tests/replay/recording_files.h"

#include <gtest/gtest.h>

namespace eventide::app {
namespace {

constexpr int kWidth = 32, kHeight = 24;

/// Exposed for 4 ms, with pixels of 8 bits.
ReferenceImage image_at(std::int64_t us) {
    ReferenceImage image;
    image.t = from_us(us);
    image.exposure_begin = from_us(us - 2000);
    image.exposure_end = from_us(us + 2000);
    image.pixels = Array2<std::uint16_t>(kHeight, kWidth);
    std::uint16_t level = 0;
    for (std::uint16_t& pixel : image.pixels.values()) pixel = std::uint16_t(level++ % 256 * 257);
    return image;
}

TEST(EcdWriter, WhatIsWrittenIsReadBack) {
    const TestFolder folder;
    constexpr std::int64_t kSince1970 = 1'589'163'147'368'867;
    Batch written;
    written.events = some_events(1000, kSince1970, 20, kWidth, kHeight);
    for (const std::int64_t after : {3'000, 7'123})
        written.images.push_back(image_at(kSince1970 + after));
    EcdWriter writer{folder.path("ecd"), false, kWidth, kHeight};
    writer.write(written);
    writer.finish();
    const Batch read = read_everything(*open_recording(folder.path("ecd")));
    EXPECT_TRUE(read.events == written.events);
    EXPECT_TRUE(read.images == written.images);
}

}  // namespace
}  // namespace eventide::app
