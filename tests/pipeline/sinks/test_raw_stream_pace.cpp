// Streams whose frames come too late: what is repeated, and what is not.
#include "pipeline/sinks/raw_stream.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/pipeline/sinks/written_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

namespace eventide {
namespace {

using test::TempFolder;

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
    EXPECT_EQ(test::y4m_times(test::read_text(temp / "skipped.y4m")),
              (std::vector<std::int64_t>{3000, 4000, 7000, 8000}));
    EXPECT_EQ(test::y4m_times(test::read_text(temp / "repeated.y4m")),
              (std::vector<std::int64_t>{3000, 4000, 4000, 4000, 7000, 8000}))
        << "what is repeated keeps the time that it shows";
    EXPECT_EQ(test::probe(temp / "repeated.y4m", "nb_read_frames"), "6\n");
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
    const auto write = [&](int n) {
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

}  // namespace
}  // namespace eventide
