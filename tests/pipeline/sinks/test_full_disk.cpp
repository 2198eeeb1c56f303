// A disk that is full after any number of bytes is an error with the file's name, for every sink.
#include "pipeline/sinks/contact_sheet.h"
#include "pipeline/sinks/folder.h"
#include "pipeline/sinks/raw_stream.h"
#include "pipeline/sinks/video/video.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/support/file_limit.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>

namespace eventide {
namespace {

using test::TempFolder;

using Open = std::function<std::unique_ptr<Sink>(const std::string& path)>;

/// Writes a few frames as the render thread does: what fails is kept, and close() comes in any
/// case.
std::string run_into(const Open& open, const std::string& path) {
    std::string first;
    const auto guarded = [&](const auto& work) {
        try {
            work();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::failed) << error.what();
            if (first.empty()) first = error.what();
        }
    };
    std::unique_ptr<Sink> sink;
    guarded([&] { sink = open(path); });
    if (!sink) return first;
    guarded([&] {
        for (int n = 0; n < 40; ++n) sink->write(test::ramp_frame(96, 64, n, test::odd_time(n)));
    });
    guarded([&] { sink->close(); });
    return first;
}

/// The largest file that a run without a limit leaves, in bytes.
std::uintmax_t most_bytes(const TempFolder& temp) {
    std::uintmax_t most = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator{temp.path()})
        if (entry.is_regular_file()) most = std::max(most, entry.file_size());
    return most;
}

/// At every byte of the first kilobyte, where headers are, and at many up to the whole run.
void expect_errors_at_every_size(const char* name, const Open& open, std::uintmax_t step) {
    const TempFolder whole;
    ASSERT_EQ(run_into(open, whole / name), "");
    // x264 and Matroska may end a few bytes earlier another time.
    const std::uintmax_t enough = most_bytes(whole) * 7 / 8;
    for (std::uintmax_t bytes = 0; bytes < enough; bytes += bytes < 1024 ? 7 : step) {
        const TempFolder temp;
        std::string words;
        {
            const test::FileLimit disk{bytes};
            words = run_into(open, temp / name);
        }
        EXPECT_NE(words.find(temp / name), std::string::npos)
            << bytes << " of " << enough << " bytes: " << words;
    }
}

TEST(FullDisk, IsAnErrorOfTheVideo) {
    for (const char* name : {"a.mp4", "a.mkv", "a.avi", "a.gif"})
        expect_errors_at_every_size(
            name,
            [](const std::string& path) {
                return std::make_unique<VideoSink>(VideoSettings{.path = path});
            },
            397);
}

TEST(FullDisk, IsAnErrorOfTheFolder) {
    expect_errors_at_every_size(
        "a",
        [](const std::string& path) {
            return std::make_unique<FolderSink>(FolderSettings{.path = path});
        },
        997);
}

TEST(FullDisk, IsAnErrorOfStreams) {
    for (const StreamFormat format : {StreamFormat::y4m, StreamFormat::gray16})
        expect_errors_at_every_size(
            "a",
            [format](const std::string& path) {
                return std::make_unique<StreamSink>(StreamSettings{.path = path, .format = format});
            },
            9973);
}

TEST(FullDisk, IsAnErrorOfTheContactSheet) {
    expect_errors_at_every_size(
        "a.png",
        [](const std::string& path) {
            return std::make_unique<ContactSheetSink>(ContactSheetSettings{.path = path});
        },
        9973);
}

}  // namespace
}  // namespace eventide
