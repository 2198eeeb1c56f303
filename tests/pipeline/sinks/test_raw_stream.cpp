// Streams: ffprobe and our own eyes read what was written; readers may go away.
#include "pipeline/sinks/raw_stream.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
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

TEST(StreamSink, HeadsY4mWithTheRateAsItWasAskedFor) {
    const TempFolder temp;
    const auto rate_in = [&](double fps, const FrameRate& rate) {
        StreamSink sink{{.path = temp / "a.y4m", .overwrite = true, .fps = fps, .rate = rate}};
        sink.write(test::ramp_frame(16, 8, 0, test::odd_time(0)));
        sink.close();
        const std::string text = test::read_text(temp / "a.y4m");
        const auto at = text.find(" F") + 2;
        return text.substr(at, text.find(' ', at) - at);
    };
    EXPECT_EQ(rate_in(30000. / 1001, {30000, 1001}), "30000:1001");
    EXPECT_EQ(rate_in(1. / 3600, {1, 3600}), "1:3600");
    EXPECT_EQ(rate_in(1. / 3600, {}), "1:3600");
    EXPECT_EQ(rate_in(1. / 30, {}), "1:30");
    EXPECT_EQ(rate_in(29.97, {}), "2997:100");
    EXPECT_EQ(rate_in(1. / 3, {1'000'000'000, 3'000'000'000}), "333:1000");
    EXPECT_EQ(rate_in(100, {300'000'000'000, 3'000'000'000}), "100:1") << "more than 31 bits";
}

/// The times in the headers of Y4M frames.
std::vector<std::int64_t> y4m_times(const std::string& bytes) {
    constexpr std::string_view kHeader = "FRAME XT=";
    std::vector<std::int64_t> times;
    for (std::size_t at = 0; (at = bytes.find(kHeader, at)) != bytes.npos; ++at)
        times.push_back(std::stoll(bytes.substr(at + kHeader.size(), 20)));
    return times;
}

TEST(StreamSink, Y4mFramesTellTheSensorsTimeInATagThatReadersPassOver) {
    const TempFolder temp;
    StreamSink sink{{.path = temp / "a.y4m", .fps = 30}};
    std::vector<std::int64_t> times;
    for (int n = 0; n < 5; ++n) {
        times.push_back(to_us(test::odd_time(n)));
        sink.write(test::ramp_frame(32, 16, n, test::odd_time(n)));
    }
    sink.close();
    EXPECT_EQ(y4m_times(test::read_text(temp / "a.y4m")), times);
    EXPECT_EQ(probe(temp / "a.y4m", "width,r_frame_rate,nb_read_frames"), "32,30/1,5\n");
}

TEST(StreamSink, AStampTellsNumberTimeAndWhatHappened) {
    const TempFolder temp;
    StreamSink sink{{.path = temp / "a", .format = StreamFormat::gray8, .stamp = true}};
    Frame frame = test::ramp_frame(4, 2, 0x0102, from_us(0x0A0B0C0D0E0F));
    frame.gap_before = true;
    sink.write(frame);
    sink.close();
    const std::string bytes = test::read_text(temp / "a");
    EXPECT_EQ(bytes.size(), FrameStamp::kBytes + 8);
    EXPECT_EQ(bytes.substr(0, FrameStamp::kBytes),
              std::string("EVF\x01\x02\x01\0\0\x0F\x0E\x0D\x0C\x0B\x0A\0\0", 16));
}

TEST(StreamSink, SkippedFramesAreRepeatedSoThatTheStreamKeepsItsPace) {
    const TempFolder temp;
    const auto write = [&](const std::string& name, Overload overload) {
        // --stamp is of the run, so Y4M beside a raw stream has it, too.
        StreamSink y4m{
            {.path = temp / (name + ".y4m"), .fps = 30, .stamp = true, .overload = overload}};
        StreamSink raw{{.path = temp / name,
                        .format = StreamFormat::gray8,
                        .stamp = true,
                        .overload = overload}};
        for (const int n : {3, 4, 7, 8}) {
            y4m.write(test::ramp_frame(4, 2, n, from_us(1000 * n)));
            raw.write(test::ramp_frame(4, 2, n, from_us(1000 * n)));
        }
        y4m.close();
        raw.close();
    };
    write("skipped", Overload::skip);
    write("repeated", Overload::repeat);
    EXPECT_EQ(y4m_times(test::read_text(temp / "skipped.y4m")),
              (std::vector<std::int64_t>{3000, 4000, 7000, 8000}));
    EXPECT_EQ(y4m_times(test::read_text(temp / "repeated.y4m")),
              (std::vector<std::int64_t>{3000, 4000, 4000, 4000, 7000, 8000}))
        << "what is repeated keeps the time that it shows";
    EXPECT_EQ(probe(temp / "repeated.y4m", "nb_read_frames"), "6\n");
    EXPECT_EQ(test::read_text(temp / "skipped").size(), 4 * (FrameStamp::kBytes + 8));
    const std::string bytes = test::read_text(temp / "repeated");
    ASSERT_EQ(bytes.size(), 6 * (FrameStamp::kBytes + 8));
    std::vector<int> flags, numbers;
    for (std::size_t at = 0; at < bytes.size(); at += FrameStamp::kBytes + 8) {
        flags.push_back(bytes[at + 3]);
        numbers.push_back(bytes[at + 4]);
    }
    EXPECT_EQ(flags, (std::vector<int>{0, 0, 2, 2, 0, 0}));
    EXPECT_EQ(numbers, (std::vector<int>{3, 4, 5, 6, 7, 8}));
}

TEST(StreamSink, FramesAreRepeatedByDefaultWhereNoStampTellsTheirTime) {
    const TempFolder temp;
    for (const bool stamp : {false, true}) {
        StreamSink raw{{.path = temp / (stamp ? "stamped" : "plain"),
                        .format = StreamFormat::gray8,
                        .stamp = stamp,
                        .overload = Overload::automatic}};
        for (const int n : {3, 6}) raw.write(test::ramp_frame(4, 2, n, from_us(1000 * n)));
        raw.close();
    }
    EXPECT_EQ(test::read_text(temp / "plain").size(), 4U * 8);
    EXPECT_EQ(test::read_text(temp / "stamped").size(), 2 * (FrameStamp::kBytes + 8));
}

TEST(StreamSink, DataWereLostBeforeAFrameAndNotBeforeItsRepeats) {
    const TempFolder temp;
    StreamSink raw{{.path = temp / "a",
                    .format = StreamFormat::gray8,
                    .stamp = true,
                    .overload = Overload::repeat}};
    Frame frame = test::ramp_frame(4, 2, 3, from_us(3000));
    frame.gap_before = true;
    raw.write(frame);
    raw.write(test::ramp_frame(4, 2, 5, from_us(5000)));
    raw.close();
    const std::string bytes = test::read_text(temp / "a");
    ASSERT_EQ(bytes.size(), 3 * (FrameStamp::kBytes + 8));
    std::vector<int> flags;
    for (std::size_t at = 0; at < bytes.size(); at += FrameStamp::kBytes + 8)
        flags.push_back(bytes[at + 3]);
    EXPECT_EQ(flags, (std::vector<int>{FrameStamp::kGap, FrameStamp::kRepeat, 0}));
}

/// A pipe of one page.
class SmallPipe {
public:
    static constexpr int kBytes = 4096;
    SmallPipe() {
        if (::pipe(ends_.data()) != 0 || ::fcntl(ends_[1], F_SETPIPE_SZ, kBytes) != kBytes)
            throw std::runtime_error("no pipe of a page");
    }
    ~SmallPipe() {
        ::close(ends_[0]);
        ::close(ends_[1]);
    }
    SmallPipe(const SmallPipe&) = delete;
    SmallPipe& operator=(const SmallPipe&) = delete;
    int reader() const { return ends_[0]; }
    std::string path() const { return "/dev/fd/" + std::to_string(ends_[1]); }

private:
    std::array<int, 2> ends_{};
};

TEST(StreamSink, AReaderOfStampsKnowsWhatIsMissingAndIsNotTold) {
    const SmallPipe pipe;
    std::uint64_t missing = 0;
    StreamSink raw{{.path = pipe.path(),
                    .format = StreamFormat::gray8,
                    .stamp = true,
                    .overload = Overload::repeat,
                    .shorter_by = [&](std::uint64_t n) { missing = n; }}};
    raw.write(test::ramp_frame(16, 127, 0, from_us(0)));  // with its stamp half a page
    raw.write(test::ramp_frame(16, 127, 3, from_us(0)));
    raw.close();
    EXPECT_EQ(missing, 0U);
}

/// The pipe is full with two frames of half a page each.
TEST(StreamSink, AReaderThatIsBehindGetsNoRepeatsUntilItHasCaughtUp) {
    constexpr int kFrame = SmallPipe::kBytes / 2;
    const SmallPipe pipe;
    std::uint64_t missing = 0;
    StreamSink raw{{.path = pipe.path(),
                    .format = StreamFormat::gray8,
                    .overload = Overload::repeat,
                    .shorter_by = [&](std::uint64_t n) { missing += n; }}};
    const auto write = [&](std::uint64_t n) {
        Frame frame = test::ramp_frame(64, kFrame / 64, n, from_us(0));
        std::ranges::fill(frame.intensity.values(), float(n) / 255);
        raw.write(frame);
    };
    const auto two_frames_read = [&] {
        std::vector<unsigned char> read(SmallPipe::kBytes);
        EXPECT_EQ(::read(pipe.reader(), read.data(), read.size()), SmallPipe::kBytes);
        return std::vector<int>{read.front(), read.back()};
    };
    write(0);
    write(3);
    EXPECT_EQ(two_frames_read(), (std::vector{0, 3})) << "1 and 2 were skipped";
    write(4);
    EXPECT_EQ(two_frames_read(), (std::vector{3, 4})) << "one of them is made up for";
    raw.close();
    raw.close();
    EXPECT_EQ(missing, 1U) << "and the other one told, once";
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
    const std::string pixels = bytes.substr(bytes.find('\n', bytes.find("FRAME")) + 1);
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

TEST(StreamSink, AReaderThatGoesAwayIsToldOnceAndTheRunMayGoOnForOthers) {
    signal(SIGPIPE, SIG_IGN);
    const TempFolder temp;
    const std::string pipe = temp / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const bool others : {true, false}) {
        const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
        int told = 0;
        std::uint64_t missing = 0;
        StreamSink sink{{.path = pipe,
                         .format = StreamFormat::gray8,
                         .overload = Overload::repeat,
                         .reader_left =
                             [&] {
                                 ++told;
                                 return others;
                             },
                         .shorter_by = [&](std::uint64_t n) { missing += n; }}};
        sink.write(test::ramp_frame(8, 8, 0, from_us(0)));
        EXPECT_TRUE(sink.is_watched());
        close(reader);
        for (int i = 1; i < 4; ++i) {
            sink.write(test::ramp_frame(8, 8, i, from_us(i)));
            EXPECT_EQ(sink.wants_more(), others) << "asked after each frame";
        }
        EXPECT_EQ(told, 1);
        EXPECT_FALSE(sink.is_watched());
        sink.close();
        EXPECT_EQ(missing, 0U) << "who went away was not too slow";
    }
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
