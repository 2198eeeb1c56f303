// Pipes and those who read them.
#include "pipeline/sinks/raw_stream.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <thread>

namespace eventide {
namespace {

using test::TempFolder;

TEST(StreamSink, AReaderThatGoesAwayIsToldOnceAndIsNoError) {
    signal(SIGPIPE, SIG_IGN);
    const TempFolder temp;
    const std::string pipe = temp / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
    int told = 0;
    std::uint64_t missing = 0;
    StreamSink sink{{.path = pipe,
                     .format = StreamFormat::gray8,
                     .overload = Overload::repeat,
                     .unread =
                         [&](const std::string& name, PipeReader why) {
                             ++told;
                             EXPECT_EQ(name, pipe);
                             EXPECT_EQ(why, PipeReader::left);
                         },
                     .shorter_by = [&](std::uint64_t n) { missing += n; }}};
    sink.write(test::ramp_frame(8, 8, 0, from_us(0)));
    EXPECT_TRUE(sink.is_watched());
    close(reader);
    for (int i = 1; i < 4; ++i) sink.write(test::ramp_frame(8, 8, 2 * i, from_us(2 * i)));
    EXPECT_EQ(told, 1);
    EXPECT_FALSE(sink.is_watched());
    sink.close();
    EXPECT_EQ(missing, 0U) << "who went away was not too slow";
}

TEST(StreamSink, APipeOfALiveSourceHoldsAboutAFrame) {
    const TempFolder temp;
    const std::string pipe = temp / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const bool live : {true, false}) {
        const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
        StreamSink sink{{.path = pipe, .format = StreamFormat::gray8, .live = live}};
        sink.write(test::ramp_frame(8, 8, 0, from_us(0)));
        EXPECT_EQ(fcntl(reader, F_GETPIPE_SZ) <= 65536 / 4, live);
        close(reader);
        sink.close();
    }
}

TEST(StreamSink, ANamedPipeWaitsForItsReaderOrGivesUp) {
    const TempFolder temp;
    const std::string pipe = temp / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    int asked = 0;
    StreamSink gave_up{{.path = pipe, .give_up = [&] { return ++asked == 2; }}};
    EXPECT_FALSE(gave_up.is_watched());

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

}  // namespace
}  // namespace eventide
