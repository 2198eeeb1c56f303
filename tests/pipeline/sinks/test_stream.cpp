// Streams: ffprobe and our own eyes read what was written; readers may go away.
#include "pipeline/sinks/stream.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <thread>

namespace eventide {
namespace {

using test::TempFolder;

std::string probe(const std::string& file, const std::string& entries) {
    const test::Result result =
        test::run({"ffprobe", "-v", "error", "-count_frames", "-select_streams", "v:0",
                   "-show_entries", "stream=" + entries, "-of", "csv=p=0", file});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.output;
}

TEST(StreamSink, FfprobeReadsY4m) {
    const TempFolder temp;
    StreamSink sink{{.path = temp / "a.y4m", .fps = 200}};
    for (int n = 0; n < 20; ++n) sink.write(test::ramp_frame(31, 17, n, test::odd_time(n)));
    sink.close();
    EXPECT_EQ(probe(temp / "a.y4m", "width,height,pix_fmt,r_frame_rate,nb_read_frames,color_range"),
              "32,18,yuv420p,pc,200/1,20\n");
}

TEST(StreamSink, MonoKeepsOddSizesAndExactGreys) {
    const TempFolder temp;
    const Frame frame = test::ramp_frame(31, 17, 3, test::odd_time(0));
    StreamSink sink{{.path = temp / "a.y4m", .format = StreamFormat::y4m_mono, .fps = 29.97}};
    sink.write(frame);
    sink.close();
    EXPECT_EQ(probe(temp / "a.y4m", "width,height,pix_fmt,r_frame_rate,nb_read_frames"),
              "31,17,gray,2997/100,1\n");
    const std::string bytes = test::read_text(temp / "a.y4m");
    const std::string pixels = bytes.substr(bytes.find("FRAME\n") + 6);
    ASSERT_EQ(pixels.size(), 31U * 17U);
    for (std::size_t i = 0; i < pixels.size(); ++i)
        EXPECT_EQ(int(std::uint8_t(pixels[i])), std::lround(frame.intensity.values()[i] * 255));
}

TEST(StreamSink, RefusesWhatAFormatCannotCarry) {
    const TempFolder temp;
    for (const auto& [format, how] : {std::pair{StreamFormat::y4m, Uncertainty::alpha},
                                      std::pair{StreamFormat::y4m, Uncertainty::separate},
                                      std::pair{StreamFormat::y4m_mono, Uncertainty::overlay},
                                      std::pair{StreamFormat::gray8, Uncertainty::overlay}})
        EXPECT_THROW((StreamSink{{.path = temp / "x", .format = format, .uncertainty = how}}),
                     Error);
}

TEST(StreamSink, AReaderThatGoesAwayEndsTheRunAndIsNoError) {
    signal(SIGPIPE, SIG_IGN);
    const TempFolder temp;
    const std::string pipe = temp / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
    StreamSink sink{{.path = pipe, .format = StreamFormat::gray8}};
    sink.write(test::ramp_frame(8, 8, 0, from_us(0)));
    EXPECT_TRUE(sink.wants_more());
    close(reader);
    sink.write(test::ramp_frame(8, 8, 1, from_us(1)));
    EXPECT_FALSE(sink.wants_more());
    sink.write(test::ramp_frame(8, 8, 2, from_us(2)));
    sink.close();
}

TEST(StreamSink, ANamedPipeWaitsForItsReaderOrGivesUp) {
    const TempFolder temp;
    const std::string pipe = temp / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    int asked = 0;
    StreamSink gave_up{{.path = pipe, .give_up = [&] { return ++asked == 2; }}};
    EXPECT_FALSE(gave_up.wants_more());

    std::string got;
    std::jthread reader{[&] { got = test::read_text(pipe); }};
    {
        StreamSink sink{{.path = pipe, .format = StreamFormat::grayf32}};
        sink.write(test::ramp_frame(8, 8, 0, from_us(0)));
        sink.close();
    }
    reader.join();
    EXPECT_EQ(got.size(), 8U * 8U * sizeof(float));
}

TEST(StreamSink, AFullDiskIsAnError) {
    StreamSink sink{{.path = "/dev/full", .format = StreamFormat::gray8}};
    EXPECT_THROW(sink.write(test::ramp_frame(8, 8, 0, from_us(0))), Error);
}

TEST(StreamSink, KeepsAFileThatExists) {
    const TempFolder temp;
    test::write_text(temp / "a.raw", "precious");
    EXPECT_THROW((StreamSink{{.path = temp / "a.raw"}}), Error);
    EXPECT_EQ(test::read_text(temp / "a.raw"), "precious");
}

}  // namespace
}  // namespace eventide
