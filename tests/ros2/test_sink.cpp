// Frames on topics, read by another participant.
#include "pipeline/ros2/diagnostics_topic.h"
#include "pipeline/ros2/ros2_sink.h"
#include "pipeline/sinks/draw_frame.h"
#include "src/core/error.h"
#include "tests/pipeline/sinks/frames.h"
#include "tests/ros2/image_cdr.h"
#include "tests/ros2/topics.h"
#include "tests/support/holdings.h"
#include "tests/system/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Image = sensor_msgs_msg_dds__Image_;
using Info = sensor_msgs_msg_dds__CameraInfo_;
using Compressed = sensor_msgs_msg_dds__CompressedImage_;

/// A sink on a name of its own. Its frames have the sensor's time since 1970 as their stamp.
class Ros2SinkTest : public testing::Test {
protected:
    std::unique_ptr<Sink> open(const std::string& keys = {}, bool with_sigma = true) {
        Ros2SinkSettings settings;
        settings.name = parse_ros2_sink_name(name_ + keys);
        settings.with_sigma = with_sigma;
        settings.say = [this](const std::string& text) { said_.push_back(text); };
        settings.warn = settings.say;
        return open_ros2_sink(std::move(settings));
    }
    static Frame frame(int n) { return ramp_frame(8, 4, n, odd_time(n)); }
    static std::int64_t stamp_us(const std_msgs_msg_dds__Header_& header) {
        return std::int64_t{header.stamp.sec} * 1'000'000 + header.stamp.nanosec / 1000;
    }
    template <typename T>
    static std::vector<T> pixels(const Image& image) {
        std::vector<T> values(image.data._length / sizeof(T));
        std::memcpy(values.data(), image.data._buffer, image.data._length);
        return values;
    }

    const std::string name_ =
        own_name("/" + std::string{testing::UnitTest::GetInstance()->current_test_info()->name()});
    std::vector<std::string> said_;
    TempFolder temp_;
};

/// The last of the process to leave the domain takes all of Cyclone DDS with it.
TEST_F(Ros2SinkTest, OpenedAndClosedLeavesNothingBehind) {
    expect_nothing_left([&] {
        const auto sink = open();
        sink->write(frame(0));
        sink->close();
    });
}

TEST_F(Ros2SinkTest, AnImageIsTheseBytes) {
    TopicReader reader{kImageType, name_ + "/image_raw"};
    const auto sink = open("?frame_id=cam");
    ASSERT_TRUE(reader.wait_for_writers(1));
    Frame small;
    small.t = from_us(1'700'000'000'250'000);
    small.window = {small.t, small.t};
    small.intensity = Array2<float>{2, 3};
    const float values[]{0, 0.2F, 0.4F, 0.6F, 1, 2};
    std::copy(std::begin(values), std::end(values), small.intensity.values().begin());
    sink->write(small);
    const auto cdr = reader.next_cdr();
    ASSERT_TRUE(cdr);
    EXPECT_THAT(*cdr, ElementsAre(0x00, 0x01, 0x00, 0x02,  // CDR, little endian, 2 bytes of padding
                                  0x00, 0xF1, 0x53, 0x65,  // stamp.sec
                                  0x80, 0xB2, 0xE6, 0x0E,  // stamp.nanosec
                                  4, 0, 0, 0, 'c', 'a', 'm', 0,            // frame_id
                                  2, 0, 0, 0, 3, 0, 0, 0,                  // height, width
                                  6, 0, 0, 0, 'm', 'o', 'n', 'o', '8', 0,  // encoding
                                  0, 0,        // is_bigendian, to step's alignment
                                  3, 0, 0, 0,  // step
                                  6, 0, 0, 0, 0, 51, 102, 153, 255, 255, 0, 0));  // data, padding
    EXPECT_EQ(*cdr,
              image_cdr(to_us(small.t), "cam", 3, 2, "mono8", 3, {0, 51, 102, 153, 255, 255}));
}

TEST_F(Ros2SinkTest, AllTopicsOfAFrameHaveItsStamp) {
    TopicReader image{kImageType, name_ + "/image_raw"}, sigma{kImageType, name_ + "/uncertainty"},
        info{kCameraInfoType, name_ + "/camera_info"},
        compressed{kCompressedImageType, name_ + "/image_raw/compressed"};
    const auto sink = open("?compressed=png");
    for (TopicReader* reader : {&image, &sigma, &info, &compressed})
        ASSERT_TRUE(reader->wait_for_writers(1));
    for (int n = 0; n < 3; ++n) {
        const Frame sent = frame(n);
        sink->write(sent);
        const Image* shown = image.next<Image>();
        ASSERT_NE(shown, nullptr);
        EXPECT_EQ(stamp_us(shown->header), to_us(sent.t));
        EXPECT_STREQ(shown->header.frame_id,
                     testing::UnitTest::GetInstance()->current_test_info()->name());
        EXPECT_STREQ(shown->encoding, "mono8");
        EXPECT_EQ(shown->step, 8U);
        std::vector<std::uint8_t> grey(32);
        to_grey8(sent.intensity.values(), 1, grey);
        EXPECT_EQ(pixels<std::uint8_t>(*shown), grey);

        const Image* uncertain = sigma.next<Image>();
        ASSERT_NE(uncertain, nullptr);
        EXPECT_EQ(stamp_us(uncertain->header), to_us(sent.t));
        EXPECT_STREQ(uncertain->encoding, "mono16");
        EXPECT_EQ(uncertain->step, 16U);
        const auto values = pixels<std::uint16_t>(*uncertain);
        for (std::size_t i = 0; i < values.size(); ++i)
            EXPECT_NEAR(values[i] / 65535.0, sent.sigma.values()[i], 0.51 / 65535) << "65535 is 1";

        const Info* told = info.next<Info>();
        ASSERT_NE(told, nullptr);
        EXPECT_EQ(stamp_us(told->header), to_us(sent.t));
        EXPECT_EQ(told->width, 8U);
        EXPECT_EQ(told->height, 4U);
        EXPECT_STREQ(told->distortion_model, "") << "not calibrated";
        EXPECT_EQ(told->k[0], 0);

        const Compressed* png = compressed.next<Compressed>();
        ASSERT_NE(png, nullptr);
        EXPECT_EQ(stamp_us(png->header), to_us(sent.t));
        EXPECT_STREQ(png->format, "mono8; png compressed mono8");
        const cv::Mat read = cv::imdecode(
            cv::Mat(1, int(png->data._length), CV_8UC1, png->data._buffer), cv::IMREAD_UNCHANGED);
        ASSERT_EQ(read.total(), grey.size());
        EXPECT_EQ(std::memcmp(read.data, grey.data(), grey.size()), 0);
    }
    ASSERT_EQ(said_.size(), 1U) << "the offset, once";
    EXPECT_THAT(said_[0], HasSubstr("stamps are the sensor's time"));
}

TEST_F(Ros2SinkTest, FloatsAreTheNumbersThemselves) {
    TopicReader image{kImageType, name_ + "/image_raw"}, sigma{kImageType, name_ + "/uncertainty"};
    const auto sink = open("?encoding=32FC1&uncertainty=32FC1");
    ASSERT_TRUE(image.wait_for_writers(1) && sigma.wait_for_writers(1));
    Frame sent = frame(1);
    sent.intensity(0, 0) = -0.25F;
    sent.intensity(0, 1) = 1.5F;
    sink->write(sent);
    const Image* shown = image.next<Image>();
    ASSERT_NE(shown, nullptr);
    EXPECT_STREQ(shown->encoding, "32FC1");
    EXPECT_EQ(shown->step, 32U);
    EXPECT_TRUE(std::ranges::equal(pixels<float>(*shown), sent.intensity.values()));
    const Image* uncertain = sigma.next<Image>();
    ASSERT_NE(uncertain, nullptr);
    EXPECT_TRUE(std::ranges::equal(pixels<float>(*uncertain), sent.sigma.values()));
}

TEST_F(Ros2SinkTest, CameraInfoIsTheCalibration) {
    write_text(temp_ / "camera.yaml",
               "cam0:\n  camera_model: pinhole\n  distortion_model: radtan\n  distortion_coeffs: "
               "[.1, .2, .3, .4]\n"
               "  intrinsics: [10, 11, 3.5, 1.5]\n  resolution: [8, 4]\n");
    TopicReader info{kCameraInfoType, name_ + "/camera_info"};
    const auto sink = open("?calibration=" + temp_ / "camera.yaml");
    ASSERT_TRUE(info.wait_for_writers(1));
    sink->write(frame(0));
    const Info* told = info.next<Info>();
    ASSERT_NE(told, nullptr);
    EXPECT_STREQ(told->distortion_model, "plumb_bob");
    EXPECT_THAT(std::vector<double>(told->d._buffer, told->d._buffer + told->d._length),
                ElementsAre(.1, .2, .3, .4, 0));
    EXPECT_THAT(told->k, ElementsAre(10, 0, 3.5, 0, 11, 1.5, 0, 0, 1));
    EXPECT_THROW(open("?calibration=" + temp_ / "none.yaml"), Error);
}

TEST_F(Ros2SinkTest, ItsWritersAreLikeThoseOfRos) {
    TopicReader image{kImageType, name_ + "/image_raw", {.reliable = false}},
        info{kCameraInfoType, name_ + "/camera_info"};
    const auto sink = open();
    ASSERT_TRUE(image.wait_for_writers(1) && info.wait_for_writers(1))
        << "also for best-effort readers";
    const TopicReader::Writer writer = image.writer();
    EXPECT_EQ(writer.type, "sensor_msgs::msg::dds_::Image_");
    EXPECT_EQ(writer.user_data, "typehash=" + std::string{kImageType.hash} + ";");
    EXPECT_EQ(writer.reliability, DDS_RELIABILITY_RELIABLE);
    EXPECT_EQ(writer.durability, DDS_DURABILITY_VOLATILE);
    EXPECT_EQ(info.writer().user_data, "typehash=" + std::string{kCameraInfoType.hash} + ";");
}

TEST_F(Ros2SinkTest, WithoutSigmaThereIsNoTopicOfIt) {
    const auto with = open();
    TopicReader sigma{kImageType, name_ + "/uncertainty"};
    EXPECT_TRUE(sigma.wait_for_writers(1)) << "the detector detects";
    with->close();
    const std::string bare = name_ + "_bare";
    Ros2SinkSettings settings;
    settings.name = parse_ros2_sink_name(bare);
    settings.with_sigma = false;
    const auto without = open_ros2_sink(std::move(settings));
    TopicReader image{kImageType, bare + "/image_raw"}, none{kImageType, bare + "/uncertainty"};
    ASSERT_TRUE(image.wait_for_writers(1));
    EXPECT_TRUE(none.wait_for_writers(0));
}

TEST_F(Ros2SinkTest, LazyIsWatchedWhileSomebodySubscribes) {
    const auto eager = open();
    EXPECT_TRUE(eager->is_watched());
    const auto lazy = open("_lazy?lazy=yes");
    EXPECT_FALSE(lazy->is_watched());
    lazy->write(frame(0));  // of no harm
    {
        TopicReader info{kCameraInfoType, name_ + "_lazy/camera_info"};
        ASSERT_TRUE(info.wait_for_writers(1));
        while (!lazy->is_watched()) std::this_thread::yield();
        lazy->write(frame(1));
        EXPECT_NE(info.next<Info>(), nullptr);
    }
    while (lazy->is_watched()) std::this_thread::yield();
}

TEST_F(Ros2SinkTest, LazyIsWatchedWhileSomebodySubscribesToAnyOfItsImages) {
    const auto lazy = open("?lazy=yes&compressed=png");
    for (const auto& [type, topic] : {std::pair{&kImageType, "/image_raw"},
                                      {&kImageType, "/uncertainty"},
                                      {&kCompressedImageType, "/image_raw/compressed"}}) {
        EXPECT_FALSE(lazy->is_watched()) << topic;
        {
            TopicReader reader{*type, name_ + topic};
            ASSERT_TRUE(reader.wait_for_writers(1)) << topic;
            while (!lazy->is_watched()) std::this_thread::yield();
        }
        while (lazy->is_watched()) std::this_thread::yield();
    }
}

TEST_F(Ros2SinkTest, LazyThatWaitsForSubscribersIsGivenItsFirstFrameToWaitWith) {
    EXPECT_TRUE(open("?lazy=yes&subscribers=1")->is_watched());
}

TEST_F(Ros2SinkTest, TheOffsetOfASensorThatCountsFromItsStartIsSaid) {
    TopicReader image{kImageType, name_ + "/image_raw"};
    const auto sink = open();
    ASSERT_TRUE(image.wait_for_writers(1));
    Frame sent = frame(0);
    sent.t = from_us(1'000);
    sent.window = {from_us(0), from_us(2'000)};
    sent.arrived = std::chrono::steady_clock::now();
    const auto before = std::chrono::system_clock::now();
    sink->write(sent);
    const Image* shown = image.next<Image>();
    ASSERT_NE(shown, nullptr);
    const std::int64_t now_us =
        std::chrono::duration_cast<std::chrono::microseconds>(before.time_since_epoch()).count();
    EXPECT_NEAR(double(stamp_us(shown->header) - now_us), -1'000, 10'000'000);
    ASSERT_EQ(said_.size(), 1U);
    EXPECT_THAT(said_[0], HasSubstr("stamps are the sensor's time + 1"));
}

TEST_F(Ros2SinkTest, DiagnosticsTellTheOffsetOnceAndThenEachSecond) {
    TopicReader diagnostics{kDiagnosticArrayType, "/diagnostics"},
        image{kImageType, name_ + "/image_raw"};
    const auto sink = open("?lazy=yes");
    ASSERT_TRUE(diagnostics.wait_for_writers(1) && image.wait_for_writers(1));
    EXPECT_EQ(diagnostics.writer().user_data,
              "typehash=" + std::string{kDiagnosticArrayType.hash} + ";");
    Frame sent = frame(0);
    const auto send_at = [&](std::int64_t us) {
        sent.t = from_us(us);
        sent.window = {from_us(us - 1000), from_us(us + 1000)};
        sent.arrived = std::chrono::steady_clock::now();
        sink->write(sent);
        const Image* shown = image.next<Image>();
        return shown == nullptr ? 0 : stamp_us(shown->header);
    };
    std::vector<std::int64_t> stamps;
    for (const std::int64_t us : {1'000, 500'000, 900'000, 1'001'000, 1'500'000})
        stamps.push_back(send_at(us));
    for (const std::size_t told : {0U, 3U}) {
        const auto* message = diagnostics.next<diagnostic_msgs_msg_dds__DiagnosticArray_>();
        ASSERT_NE(message, nullptr);
        EXPECT_EQ(stamp_us(message->header), stamps[told]);
        ASSERT_EQ(message->status._length, 1U);
        const auto& status = message->status._buffer[0];
        EXPECT_EQ(status.level, 0);
        EXPECT_EQ(status.name, "eventide: " + name_ + " stamps");
        EXPECT_THAT(status.message, HasSubstr(said_[0].substr(said_[0].find("stamps are"))));
        ASSERT_EQ(status.values._length, 3U);
        EXPECT_STREQ(status.values._buffer[0].key, "offset_s");
        EXPECT_NEAR(std::stod(status.values._buffer[0].value), double(stamps[0] - 1'000) / 1e6,
                    2e-6);
        EXPECT_STREQ(status.values._buffer[2].key, "sensor_time_s");
        EXPECT_STREQ(status.values._buffer[2].value, told == 0 ? "0.001000" : "1.001000");
    }
    EXPECT_EQ(said_.size(), 1U);
}

TEST_F(Ros2SinkTest, WhoComesToTheDiagnosticsWithinASecondIsToldAtOnce) {
    using Diagnostics = diagnostic_msgs_msg_dds__DiagnosticArray_;
    DiagnosticsTopic topic{Participant::join(), name_};
    const auto wait_for_readers = [&](int n) {
        while (topic.writer.readers() != n) std::this_thread::yield();
    };
    std::int64_t stamp = to_us(odd_time(0));
    std::optional<TopicReader> reader{std::in_place, kDiagnosticArrayType, "/diagnostics"};
    wait_for_readers(1);
    topic.tell({.stamp_us = stamp});
    ASSERT_NE(reader->next<Diagnostics>(), nullptr);
    reader.reset();
    wait_for_readers(0);
    topic.tell({.stamp_us = stamp += 1'000});
    reader.emplace(kDiagnosticArrayType, "/diagnostics");
    wait_for_readers(1);
    topic.tell({.stamp_us = stamp += 1'000});
    const auto* late = reader->next<Diagnostics>(std::chrono::seconds{5});
    ASSERT_NE(late, nullptr);
    EXPECT_EQ(stamp_us(late->header), stamp);
}

TEST_F(Ros2SinkTest, WhoReadsDiagnosticsMakesNoFrames) {
    TopicReader diagnostics{kDiagnosticArrayType, "/diagnostics"};
    const auto sink = open("?lazy=yes");
    ASSERT_TRUE(diagnostics.wait_for_writers(1));
    EXPECT_FALSE(sink->is_watched());
}

TEST_F(Ros2SinkTest, WaitsForItsSubscribers) {
    std::optional<TopicReader> image;
    Ros2SinkSettings settings;
    settings.name = parse_ros2_sink_name(name_ + "?subscribers=1");
    settings.give_up = [&] {  // asked while it waits
        if (!image) image.emplace(kImageType, name_ + "/image_raw");
        return false;
    };
    const auto sink = open_ros2_sink(std::move(settings));
    sink->write(frame(0));
    ASSERT_TRUE(image) << "it did not wait";
    const Image* shown = image->next<Image>();
    ASSERT_NE(shown, nullptr);
    EXPECT_EQ(stamp_us(shown->header), to_us(frame(0).t)) << "the very first";
}

TEST_F(Ros2SinkTest, GivesUpWaitingForSubscribersWhenItIsTold) {
    Ros2SinkSettings settings;
    settings.name = parse_ros2_sink_name(name_ + "?subscribers=1");
    settings.give_up = [] { return true; };
    open_ros2_sink(std::move(settings))->write(frame(0));
}

}  // namespace
}  // namespace eventide::test
