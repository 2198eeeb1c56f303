// SINK on the command line: what each of its forms names.
#include "apps/cli/settings/sink_name.h"
#include "src/core/error.h"
#include "tests/system/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <string>

namespace eventide::app {
namespace {

using testing::HasSubstr;

TEST(SinkName, IsKnownByItsPrefixOrItsExtension) {
    for (const auto& [text, kind, path] : {std::tuple{"null", SinkKind::nothing, ""},
                                           {"window", SinkKind::window, ""},
                                           {"-", SinkKind::stream, "-"},
                                           {"x.y4m", SinkKind::stream, "x.y4m"},
                                           {"X.Y4M", SinkKind::stream, "X.Y4M"},
                                           {"gray16:x.mp4", SinkKind::stream, "x.mp4"},
                                           {"x.mp4", SinkKind::video, "x.mp4"},
                                           {"X.GIF", SinkKind::video, "X.GIF"},
                                           {"x/", SinkKind::folder, "x/"},
                                           {"folder:x", SinkKind::folder, "x"},
                                           {"contact-sheet:x.png", SinkKind::sheet, "x.png"},
                                           {"v4l2:/dev/video9", SinkKind::v4l2, "/dev/video9"},
                                           {"ros2:/camera", SinkKind::ros2, "/camera"}}) {
        EXPECT_EQ(parse_sink(text).kind, kind) << text;
        EXPECT_EQ(parse_sink(text).path, path) << text;
    }
    EXPECT_EQ(parse_sink("-").format, StreamFormat::y4m);
    EXPECT_EQ(parse_sink("y4m-mono:-").format, StreamFormat::y4m_mono);
    EXPECT_EQ(parse_sink("gray16:-").format, StreamFormat::gray16);
}

TEST(SinkName, AFolderOrNamedPipeThatIsThereIsKnownByWhatItIs) {
    const test::TempFolder temp;
    EXPECT_EQ(parse_sink(temp.path().string()).kind, SinkKind::folder);
    const std::string pipe = temp / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_EQ(parse_sink(pipe).kind, SinkKind::stream);
    EXPECT_EQ(parse_sink(pipe).path, pipe);
}

TEST(SinkName, SaysWhatIsMissing) {
    for (const auto& [text, words] :
         {std::pair{"gray8:", "--out gray8: needs a path, such as --out gray8:x"},
          {"v4l2:", "such as --out v4l2:/dev/video9"},
          {"ros2:", "such as --out ros2:/camera"},
          {"contact-sheet:", "such as --out contact-sheet:x.png"},
          {"x.bmp", "--out x.bmp: expected a folder (ending in /), x.mp4"}})
        try {
            parse_sink(text);
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            EXPECT_THAT(error.what(), HasSubstr(words));
        }
}

TEST(SinkName, WhatIsTooLongForAFileIsRefusedAsAnyOther) {
    EXPECT_THROW(parse_sink(std::string(300, 'x')), Error);
}

}  // namespace
}  // namespace eventide::app
