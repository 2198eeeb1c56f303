// Subscribers in processes of their own, over loopback: of Cyclone DDS and of Fast DDS, quick,
// slow, stopped and late.
#include "pipeline/ros2/ros2_sink.h"
#include "pipeline/sinks/draw_frame.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/ros2/image_cdr.h"
#include "tests/ros2/topics.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <signal.h>

#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace eventide::test {
namespace {

constexpr int kWidth = 640, kHeight = 480;  // five fragments

class Listeners : public testing::Test {
protected:
    std::unique_ptr<Sink> open(const std::string& keys = {}) {
        Ros2SinkSettings settings;
        settings.name = parse_ros2_sink_name(name_ + keys);
        return open_ros2_sink(std::move(settings));
    }
    std::unique_ptr<Process> listener(bool reliable) {
        return std::make_unique<Process>(
            std::vector<std::string>{EVENTIDE_ROS2_LISTENER, name_ + "/image_raw", "image",
                                     reliable ? "reliable" : "best_effort"},
            ProcessSettings{.output_to_pipe = true});
    }
    static void expect_ready(Process& process) {
        ASSERT_EQ(process.read_output(kLineBytes), ready_line());
    }
    static Frame frame(int n) { return ramp_frame(kWidth, kHeight, n, odd_time(n)); }
    /// What a listener prints of it.
    std::string line(int n) const {
        std::vector<std::uint8_t> grey(std::size_t{kWidth} * kHeight);
        to_grey8(frame(n).intensity.values(), 1, grey);
        const std::string frame_id = name_.substr(name_.rfind('/') + 1);
        return message_line(
            image_cdr(to_us(odd_time(n)), frame_id, kWidth, kHeight, "mono8", kWidth, grey));
    }
    /// The stamp of the next message, in us.
    static std::int64_t next_stamp(Process& process) {
        const std::string text = process.read_output(kLineBytes);
        return text.size() == kLineBytes ? std::stoll(text, nullptr, 16) : 0;
    }

    const std::string name_ =
        own_name("/" + std::string{testing::UnitTest::GetInstance()->current_test_info()->name()});
};

TEST_F(Listeners, BothKindsGetEveryImageBitForBit) {
    const auto reliable = listener(true), best_effort = listener(false);
    const auto sink = open("?subscribers=2");
    expect_ready(*reliable);
    expect_ready(*best_effort);
    for (int n = 0; n < 40; ++n) {
        sink->write(frame(n));
        ASSERT_EQ(reliable->read_output(kLineBytes), line(n)) << n;
        ASSERT_EQ(best_effort->read_output(kLineBytes), line(n)) << n;
    }
}

TEST_F(Listeners, OneThatStoppedHarmsNobody) {
    const auto healthy = listener(true), stopped = listener(true);
    const auto sink = open("?subscribers=2");
    expect_ready(*healthy);
    expect_ready(*stopped);
    sink->write(frame(0));
    ASSERT_EQ(healthy->read_output(kLineBytes), line(0));
    ASSERT_EQ(stopped->read_output(kLineBytes), line(0));
    stopped->signal(SIGSTOP);
    constexpr int kFrames = 60;
    for (int n = 1; n <= kFrames; ++n) {
        sink->write(frame(n));  // returns, and throws nothing
        ASSERT_EQ(healthy->read_output(kLineBytes), line(n)) << n;
    }
    stopped->signal(SIGCONT);
    // It goes on with what is new: the last one comes, whatever it missed.
    std::int64_t stamp = 0;
    while (stamp < to_us(odd_time(kFrames))) {
        stamp = next_stamp(*stopped);
        ASSERT_GT(stamp, 0);
    }
    EXPECT_EQ(stamp, to_us(odd_time(kFrames)));
}

TEST_F(Listeners, OneThatIsKilledHarmsNobody) {
    const auto healthy = listener(true);
    auto doomed = listener(true);
    const auto sink = open("?subscribers=2");
    expect_ready(*healthy);
    expect_ready(*doomed);
    sink->write(frame(0));
    ASSERT_EQ(doomed->read_output(kLineBytes), line(0));
    doomed->signal(SIGKILL);
    for (int n = 0; n < 30; ++n) {
        if (n > 0) sink->write(frame(n));
        ASSERT_EQ(healthy->read_output(kLineBytes), line(n)) << n;
    }
}

TEST_F(Listeners, OneThatComesLateGetsWhatIsNew) {
    const auto sink = open("?lazy=yes");  // so that it says when somebody has come
    constexpr int kBefore = 5;
    for (int n = 0; n < kBefore; ++n) sink->write(frame(n));
    const auto late = listener(true);
    expect_ready(*late);
    while (!sink->is_watched()) std::this_thread::yield();
    sink->write(frame(kBefore));
    EXPECT_EQ(late->read_output(kLineBytes), line(kBefore))
        << "images are not kept for those who come late";
}

#ifdef EVENTIDE_FASTDDS_PEER
class FastDds : public Listeners {
protected:
    std::unique_ptr<Process> peer(const std::string& kind) {
        return std::make_unique<Process>(
            std::vector<std::string>{EVENTIDE_FASTDDS_PEER, "listen", name_ + "/image_raw", kind},
            ProcessSettings{.output_to_pipe = true});
    }
};

TEST_F(FastDds, GetsEveryImageBitForBit) {
    const auto reliable = peer("reliable"), best_effort = peer("best_effort");
    const auto sink = open("?subscribers=2");
    expect_ready(*reliable);
    expect_ready(*best_effort);
    for (int n = 0; n < 40; ++n) {
        sink->write(frame(n));
        ASSERT_EQ(reliable->read_output(kLineBytes), line(n)) << n;
        ASSERT_EQ(best_effort->read_output(kLineBytes), line(n)) << n;
    }
}
#endif

}  // namespace
}  // namespace eventide::test
