// What players and libraries of others make of the stream.
#include "tests/pipeline/sinks/http/served.h"
#include "tests/system/process.h"

#include <set>
#include <sstream>

namespace eventide::test {
namespace {

std::string stream_of(const HttpSink& sink) {
    return "http://127.0.0.1:" + std::to_string(sink.address().port) + "/stream";
}

TEST(HttpPlayers, OpenCvReadsTheStreamByItsAddress) {
    const auto sink = open_page();
    const Frames frames{*sink};
    const Result read = run({EVENTIDE_OPENCV_PLAYER, stream_of(*sink)});
    EXPECT_EQ(read.exit_code, 0) << read.error;
    EXPECT_EQ(read.output, "64x48x3\n");
}

TEST(HttpPlayers, FfmpegReadsTheStreamByItsAddress) {
    const auto sink = open_page();
    const Frames frames{*sink};
    const Result read = run({"ffmpeg", "-nostdin", "-loglevel", "error", "-i", stream_of(*sink),
                             "-frames:v", "5", "-f", "framemd5", "-"});
    EXPECT_EQ(read.exit_code, 0) << read.error;
    std::set<std::string> different;
    std::istringstream lines{read.output};
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with('#')) different.insert(line.substr(line.rfind(' ')));
    EXPECT_EQ(different.size(), 5U) << read.output;
}

}  // namespace
}  // namespace eventide::test
