// A folder of the Event Camera Dataset: what is written is read back.
#include "apps/cli/commands/ecd_writer.h"
#include "src/core/error.h"
#include "tests/replay/recording_files.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>

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

/// What becomes of the file of that name: replaced by a new conversion with `overwrite`, or
/// refused.
bool replaces(const std::filesystem::path& folder, const std::string& name, const Batch& data) {
    test::write_text(folder / name, "mine");
    try {
        EcdWriter writer{folder, true, kWidth, kHeight};
        writer.write(data);
        writer.finish();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        EXPECT_NE(std::string{error.what()}.find(name), std::string::npos) << error.what();
        EXPECT_EQ(test::read_text(folder / name), "mine");
        return false;
    }
    return true;
}

TEST(EcdWriter, ReplacesOnlyWhatAnEarlierConversionWrote) {
    Batch data;
    data.events = some_events(1000, 1'000'000, 20, kWidth, kHeight);
    const TestFolder folder;
    const std::filesystem::path of_events = folder.path("events"), of_both = folder.path("both"),
                                of_before = folder.path("before");
    Batch with_image = data;
    with_image.images.push_back(image_at(1'003'000));
    for (const auto& [into, written] :
         {std::pair{&of_events, &data}, {&of_both, &with_image}, {&of_before, &with_image}}) {
        EcdWriter writer{*into, false, kWidth, kHeight};
        writer.write(*written);
        writer.finish();
    }
    EXPECT_FALSE(replaces(of_events, "exposure.txt", data)) << "it had no images";
    EXPECT_TRUE(replaces(of_both, "exposure.txt", with_image));
    // Earlier versions wrote no exposures, and did not name what they wrote.
    test::write_text(of_before / "run.json",
                     R"({"program": "eventide", "files": {"images": 1}, "finished": true})");
    EXPECT_FALSE(replaces(of_before, "exposure.txt", with_image));
    std::filesystem::remove(of_before / "exposure.txt");
    EXPECT_TRUE(replaces(of_before, "images.txt", with_image));
}

}  // namespace
}  // namespace eventide::app
