// eventide run between ROS 2 topics, as a user starts it.
#include "src/core/byte_order.h"
#include "tests/ros2/topics.h"
#include "tests/support/manager_socket.h"
#include "tests/system/program_test.h"

#include <gmock/gmock.h>

#include <signal.h>

#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using Image = sensor_msgs_msg_dds__Image_;

constexpr std::size_t kPixels = 64 * 48;

class Ros2Program : public ProgramTest {
protected:
    const std::string name_ =
        own_name("/" + std::string{testing::UnitTest::GetInstance()->current_test_info()->name()});
};

std::int64_t stamp_us(const std_msgs_msg_dds__Header_& header) {
    return std::int64_t{header.stamp.sec} * 1'000'000 + header.stamp.nanosec / 1000;
}

TEST_F(Ros2Program, PublishesTheFramesThatItWrites) {
    TopicReader image{kImageType, name_ + "/image_raw"}, sigma{kImageType, name_ + "/uncertainty"};
    Process process =
        start({"run", recording(), "--fps", "50", "--out", "ros2:" + name_ + "?subscribers=1",
               "--out", "gray8:frames.raw", "--stamp", "--stats", "stats.jsonl"});
    // Its own writer may come before the other: what is compared is what has come.
    std::vector<std::int64_t> stamps;
    std::vector<std::string> pixels;
    const auto take = [&](const Image* shown) {
        stamps.push_back(stamp_us(shown->header));
        pixels.emplace_back(reinterpret_cast<const char*>(shown->data._buffer),
                            shown->data._length);
    };
    while (const Image* shown =
               image.next<Image>(std::chrono::milliseconds{process.running() ? 100 : 0}))
        take(shown);
    while (process.running())
        if (const Image* shown = image.next<Image>(std::chrono::milliseconds{100})) take(shown);
    const Result result = process.wait();
    ASSERT_EQ(result.exit_code, 0) << result.error;
    while (const Image* shown = image.next<Image>(std::chrono::milliseconds{0})) take(shown);
    const std::string raw = read_text(temp_ / "frames.raw");
    constexpr std::size_t kFrame = 16 + kPixels;
    ASSERT_EQ(raw.size() % kFrame, 0U);
    ASSERT_EQ(pixels.size(), raw.size() / kFrame) << "every frame";
    std::optional<std::int64_t> offset;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
        EXPECT_EQ(pixels[k], raw.substr(k * kFrame + 16, kPixels)) << k;
        const auto t_us = load_little<std::int64_t>(
            reinterpret_cast<const std::byte*>(raw.data() + k * kFrame + 8));
        if (!offset) offset = stamps[k] - t_us;
        EXPECT_EQ(stamps[k] - t_us, *offset) << "one offset for all";
    }
    EXPECT_NE(sigma.next<Image>(std::chrono::milliseconds{0}), nullptr);
    EXPECT_THAT(result.error, HasSubstr("ros2:" + name_ + ": stamps are the sensor's time"));
}

TEST_F(Ros2Program, CameraInfoOfUndistortedFramesSaysSo) {
    write_text(temp_ / "cam.yaml",
               "cam0:\n  camera_model: pinhole\n  distortion_model: radtan\n"
               "  distortion_coeffs: [-0.3, 0.1, 0, 0]\n  intrinsics: [45, 46, 31.5, 23.5]\n"
               "  resolution: [64, 48]\n");
    TopicReader info{kCameraInfoType, name_ + "/camera_info"};
    Process process =
        start({"run", recording(), "--fps", "50", "--undistort", "cam.yaml", "--size", "2x",
               "--crop", "4", "--out", "ros2:" + name_ + "?subscribers=0", "--speed", "0.5"});
    ASSERT_TRUE(info.wait_for_writers(1));
    const auto* told = info.next<sensor_msgs_msg_dds__CameraInfo_>();
    ASSERT_NE(told, nullptr);
    EXPECT_EQ(told->width, 120U);
    EXPECT_EQ(told->height, 88U);
    EXPECT_STREQ(told->distortion_model, "plumb_bob");
    EXPECT_THAT(std::vector<double>(told->d._buffer, told->d._buffer + told->d._length),
                testing::ElementsAre(0, 0, 0, 0, 0));
    const double x = 127. / 63, y = 95. / 47;  // corners on corners
    using testing::DoubleEq;
    EXPECT_THAT(told->k, testing::ElementsAre(DoubleEq(45 * x), 0, DoubleEq(31.5 * x - 4), 0,
                                              DoubleEq(46 * y), DoubleEq(23.5 * y - 4), 0, 0, 1));
    EXPECT_EQ(process.wait().exit_code, 0);
    const Result both = eventide({"run", recording(), "--undistort", "cam.yaml", "--out",
                                  "ros2:" + name_ + "?calibration=cam.yaml"});
    EXPECT_EQ(both.exit_code, 2);
    EXPECT_THAT(both.error, HasSubstr("expected one of them"));
}

TEST_F(Ros2Program, CannotShowSigmaInsideTheImage) {
    const Result result =
        eventide({"run", recording(), "--out", "ros2:" + name_, "--uncertainty", "side"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.error,
                HasSubstr("expected --uncertainty auto, none or separate, found side"));
}

TEST_F(Ros2Program, NamesAreCheckedBeforeAnythingIsWritten) {
    const Result result = eventide(
        {"run", recording(), "--out", "frames.y4m", "--out", "ros2:" + name_ + "?encoding=rgb8"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_FALSE(std::filesystem::exists(temp_ / "frames.y4m"));
    const Result none = eventide({"run", recording(), "--out", "ros2:"});
    EXPECT_EQ(none.exit_code, 2);
    EXPECT_THAT(none.error, HasSubstr("--out ros2:/camera"));
    const Result calibration = eventide({"run", recording(), "--out", "a.png", "--out",
                                         "ros2:" + name_ + "?calibration=none.yaml"});
    EXPECT_NE(calibration.exit_code, 0);
}

TEST_F(Ros2Program, AWrongEnvironmentIsNamed) {
    const Result domain = eventide({"run", recording(), "--out", "ros2:" + name_},
                                   {.environment = {{"ROS_DOMAIN_ID", "300"}}});
    EXPECT_EQ(domain.exit_code, 2);
    EXPECT_THAT(domain.error, HasSubstr("ROS_DOMAIN_ID: expected 0 to 232, found '300'"));
    const Result config = eventide({"run", recording(), "--out", "ros2:" + name_},
                                   {.environment = {{"CYCLONEDDS_URI", "<Nonsense/>"}}});
    EXPECT_EQ(config.exit_code, 1);
    EXPECT_THAT(config.error, HasSubstr("CYCLONEDDS_URI"));
}

TEST_F(Ros2Program, LazyRendersNothingWhileNobodySubscribes) {
    const Result result = eventide({"run", recording(), "--fps", "50", "--out",
                                    "ros2:" + name_ + "?lazy=yes", "--stats", "stats.jsonl"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(read_text(temp_ / "stats.jsonl"), HasSubstr("\"frames\":0,"));
    EXPECT_THAT(result.error, testing::Not(HasSubstr("no frame")));
}

TEST_F(Ros2Program, AnInterruptEndsItsWaitForSubscribersAndForMessages) {
    Process sink = start({"run", recording(), "--out", "ros2:" + name_ + "?subscribers=1"});
    {
        TopicReader image{kImageType,
                          name_ + "/uncertainty"};  // it is there, and waits for readers of images
        ASSERT_TRUE(image.wait_for_writers(1));
    }
    sink.signal(SIGINT);
    EXPECT_EQ(sink.wait().exit_code, 0);
    Process source = start({"run", "ros2:" + name_ + "/events?wait=600s", "--out", "null"});
    EventPublisher publisher{name_ + "/events"};
    publisher.wait_for_readers(1);  // it has begun to wait
    source.signal(SIGINT);
    const Result result = source.wait();
    EXPECT_THAT(result.error, HasSubstr("stopped before the first message"));
}

TEST_F(Ros2Program, AServiceThatWaitsForItsDriverHasStartedAndIsAlive) {
    ManagerSocket socket{temp_ / "notify"};
    Process process = start(
        {"run", "ros2:" + name_ + "/events", "--reconnect", "--out", "null"},
        {.environment = {{"NOTIFY_SOCKET", temp_ / "notify"}, {"WATCHDOG_USEC", "30000000"}}});
    std::vector<std::string> messages;
    while (process.running() && (messages.empty() || messages.back() != "WATCHDOG=1"))
        if (const std::string next = socket.next(); next != "nothing") messages.push_back(next);
    process.signal(SIGTERM);
    EXPECT_EQ(process.wait().exit_code, 0);
    EXPECT_THAT(messages,
                testing::ElementsAre("READY=1", "STATUS=waiting for ros2:" + name_ + "/events",
                                     "WATCHDOG=1"));
}

/// Events in, images out: a driver, eventide and a node of ROS 2.
TEST_F(Ros2Program, MakesImagesOfADriversEvents) {
    EventPublisher driver{name_ + "/events"};
    TopicReader image{kImageType, name_ + "/image_raw"};
    Process process = start({"run", "ros2:" + name_ + "/events?wait=60s", "--fps", "100", "--out",
                             "ros2:" + name_, "--record", "kept.txt"});
    driver.wait_for_readers(1);
    constexpr std::int64_t kStamp = 1'700'000'000'000'000'000;
    EventPublisher::Message message;
    message.stamp_ns = kStamp;
    const Image* shown = nullptr;
    // In real time or not: 10 ms of the sensor in each message, until an image has come.
    for (std::uint64_t k = 0; k < 3000 && shown == nullptr; ++k) {
        message.seq = k;
        message.time_base = 10'000'000 * k;
        message.stamp_ns = kStamp + std::int64_t(message.time_base);
        message.payload.clear();
        for (std::uint64_t i = 0; i < 100; ++i)
            append_little(message.payload, i * 100'000 | ((i * 7 + k) % 64) << 32 |
                                               (i * 5 % 48) << 48 | (i % 2) << 63);
        driver.publish(message);
        shown = image.next<Image>(std::chrono::milliseconds{10});
    }
    ASSERT_NE(shown, nullptr);
    EXPECT_EQ(shown->width, 64U);
    EXPECT_NEAR(double(stamp_us(shown->header)), double(kStamp) / 1000, 60e6)
        << "ROS time, as the driver's stamps";
    EXPECT_EQ(stamp_us(shown->header) % 10'000, 9'999)
        << "and not shifted: t0 lies 1 us before the first event";
    process.signal(SIGINT);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_GT(read_text(temp_ / "kept.txt").size(), 1000U);
}

TEST_F(Ros2Program, DoctorLooksAtIt) {
    const Result result = eventide({"doctor", "--json"});
    EXPECT_THAT(result.output, HasSubstr("Cyclone DDS"));
    EXPECT_THAT(result.output, HasSubstr("net.core.rmem_max"));
    EXPECT_THAT(result.output, HasSubstr("interface lo (udp/127.0.0.1)"));
}

}  // namespace
}  // namespace eventide::test
