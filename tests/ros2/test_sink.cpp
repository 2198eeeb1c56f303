// Frames on topics, read by another participant.
#include "pipeline/sinks/draw_frame.h"
#include "src/core/error.h"
#include "tests/ros2/image_cdr.h"
#include "tests/ros2/sink_test.h"
#include "tests/support/holdings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace eventide::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

}  // namespace
}  // namespace eventide::test
