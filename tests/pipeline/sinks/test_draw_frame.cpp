// Floats become bytes, and sigma becomes visible, as the headers promise.
#include "pipeline/sinks/draw_frame.h"
#include "pipeline/sinks/raw_pixels.h"
#include "pipeline/sinks/video/yuv.h"
#include "tests/pipeline/sinks/frames.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace eventide {
namespace {

TEST(Image, RoundsAndClampsAndTurnsNanBlack) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<float> values{-1, 0, 0.5f, 1, 2, nan, inf, -inf, 100.4f / 255, 100.6f / 255};
    std::vector<std::uint8_t> grey8(values.size());
    to_grey8(values, 1.0f, grey8);
    EXPECT_EQ(grey8, (std::vector<std::uint8_t>{0, 0, 128, 255, 255, 0, 255, 0, 100, 101}));
    std::vector<std::uint16_t> grey16(values.size());
    to_grey16(values, 2.0f, grey16);
    EXPECT_EQ(grey16[3], 32768);
    EXPECT_EQ(grey16[4], 65535);
}

TEST(Image, ShowsSigmaAtTheRightInItsOwnScale) {
    Frame frame = test::ramp_frame(5, 3, 0, from_us(0));
    for (float& s : frame.sigma.values()) s = 0.2f;
    cv::Mat image;
    draw(frame, Uncertainty::side, 0.3f, image);
    ASSERT_EQ(image.cols, 10);
    EXPECT_EQ(int(image.at<std::uint8_t>(2, 7)), 170);
    EXPECT_EQ(int(image.at<std::uint8_t>(2, 3)), 3 * 3 + 2 * 2);
}

TEST(Image, OverlayIsTheIntensityWhereCertainAndRedWhereNot) {
    Frame frame = test::ramp_frame(2, 1, 0, from_us(0));
    frame.intensity(0, 0) = frame.intensity(0, 1) = 0.4f;
    frame.sigma(0, 0) = 0;
    frame.sigma(0, 1) = 9;
    cv::Mat image;
    draw(frame, Uncertainty::overlay, 0.3f, image);
    EXPECT_EQ(image.at<cv::Vec3b>(0, 0), cv::Vec3b(102, 102, 102));
    EXPECT_EQ(image.at<cv::Vec3b>(0, 1), cv::Vec3b(0, 0, 255));
    frame.sigma(0, 0) = 0.3f * 128 / 255;
    draw(frame, Uncertainty::overlay, 0.3f, image);
    EXPECT_EQ(image.at<cv::Vec3b>(0, 0), cv::Vec3b(51, 51, 179)) << "50.8 of the grey are left";
}

TEST(Image, AlphaIsOpaqueWhereCertain) {
    Frame frame = test::ramp_frame(2, 1, 0, from_us(0));
    frame.sigma(0, 0) = 0;
    frame.sigma(0, 1) = 0.3f;
    cv::Mat image;
    draw(frame, Uncertainty::alpha, 0.3f, image);
    EXPECT_EQ(int(image.at<cv::Vec4b>(0, 0)[3]), 255);
    EXPECT_EQ(int(image.at<cv::Vec4b>(0, 1)[3]), 0);
}

TEST(Image, AFrameWithoutSigmaIsShownAsCertain) {
    Frame frame = test::ramp_frame(4, 4, 0, from_us(0));
    frame.sigma = {};
    cv::Mat image;
    for (const Uncertainty how : {Uncertainty::side, Uncertainty::alpha, Uncertainty::overlay})
        draw(frame, how, 0.3f, image);
    EXPECT_EQ(image.at<cv::Vec3b>(3, 3)[0], image.at<cv::Vec3b>(3, 3)[2]);
}

TEST(Image, ShowsEventsOnlyWhereThereIsAPreview) {
    Frame frame = test::ramp_frame(4, 4, 0, from_us(0));
    cv::Mat image(1, 1, CV_8UC1);
    draw_events(frame, image);
    EXPECT_TRUE(image.empty());
    frame.event_preview = Array2<float>{1, 3};
    frame.event_preview(0, 0) = 2;
    frame.event_preview(0, 1) = -1;
    draw_events(frame, image);
    const auto on = image.at<cv::Vec3b>(0, 0), off = image.at<cv::Vec3b>(0, 1);
    EXPECT_GT(on[2], on[0]);
    EXPECT_GT(off[0], off[2]);
    EXPECT_EQ(image.at<cv::Vec3b>(0, 2), cv::Vec3b(255, 255, 255));
}

TEST(RawPixels, FloatsPassBitForBitInEveryArrangement) {
    const Frame frame = test::ramp_frame(3, 2, 1, from_us(0));
    std::vector<std::byte> separate, side;
    append_pixels<float>(frame, {Uncertainty::separate, 0.3f}, separate);
    append_pixels<float>(frame, {Uncertainty::side, 0.3f}, side);
    ASSERT_EQ(separate.size(), 2 * 6 * sizeof(float));
    EXPECT_EQ(std::memcmp(separate.data(), frame.intensity.values().data(), 24), 0);
    EXPECT_EQ(std::memcmp(separate.data() + 24, frame.sigma.values().data(), 24), 0);
    EXPECT_EQ(std::memcmp(side.data() + 12, frame.sigma.row(0).data(), 12), 0);
    EXPECT_EQ(std::memcmp(side.data() + 24, frame.intensity.row(1).data(), 12), 0);
}

TEST(RawPixels, AlphaInterleavesIntensityAndConfidence) {
    Frame frame = test::ramp_frame(1, 1, 0, from_us(0));
    frame.intensity(0, 0) = 1;
    frame.sigma(0, 0) = 0.3f;
    std::vector<std::byte> bytes;
    append_pixels<std::uint16_t>(frame, {Uncertainty::alpha, 0.3f}, bytes);
    EXPECT_EQ(bytes,
              (std::vector<std::byte>{std::byte{255}, std::byte{255}, std::byte{0}, std::byte{0}}));
}

TEST(RawPixels, ConfidenceEndsAtZeroAndIsWholeWithoutSigma) {
    Frame frame = test::ramp_frame(1, 1, 0, from_us(0));
    frame.sigma(0, 0) = 9;
    std::vector<std::byte> bytes;
    append_pixels<float>(frame, {Uncertainty::alpha, 0.3f}, bytes);
    std::array<float, 2> pair{};
    std::memcpy(pair.data(), bytes.data(), sizeof pair);
    EXPECT_EQ(pair[1], 0);
    frame.sigma = {};
    bytes.clear();
    append_pixels<float>(frame, {Uncertainty::alpha, 0.3f}, bytes);
    std::memcpy(pair.data(), bytes.data(), sizeof pair);
    EXPECT_EQ(pair[1], 1);
}

TEST(RawPixels, SigmaThatIsShownAsWhiteIsWhiteBesideAndBehind) {
    Frame frame = test::ramp_frame(1, 1, 0, from_us(0));
    frame.sigma(0, 0) = 0.1f;
    for (const Uncertainty how : {Uncertainty::side, Uncertainty::separate}) {
        std::vector<std::byte> bytes;
        append_pixels<std::uint8_t>(frame, {how, 0.1f}, bytes);
        EXPECT_EQ(bytes.at(1), std::byte{255});
    }
}

TEST(Yuv, KeepsGreyInFullRangeAndRepeatsTheLastRowAndColumn) {
    cv::Mat image(3, 3, CV_8UC1);
    for (int i = 0; i < 9; ++i) image.data[i] = std::uint8_t(20 * i);
    std::array<std::uint8_t, 16> luma{};
    std::array<std::uint8_t, 4> blue{}, red{};
    to_yuv420(image, YuvCoding::jpeg,
              {Plane{luma.data(), 4}, Plane{blue.data(), 2}, Plane{red.data(), 2}});
    EXPECT_EQ(luma, (std::array<std::uint8_t, 16>{0, 20, 40, 40, 60, 80, 100, 100, 120, 140, 160,
                                                  160, 120, 140, 160, 160}));
    EXPECT_EQ(blue, (std::array<std::uint8_t, 4>{128, 128, 128, 128}));
    EXPECT_EQ(red, blue);
}

TEST(Yuv, KnowsTheCornersOfBt709) {
    const cv::Mat red(2, 2, CV_8UC3, cv::Scalar{0, 0, 255});
    std::array<std::uint8_t, 4> luma{};
    std::uint8_t u = 0, v = 0;
    to_yuv420(red, YuvCoding::video, {Plane{luma.data(), 2}, Plane{&u, 1}, Plane{&v, 1}});
    EXPECT_EQ(int(luma[0]), 63);  // 16 + 219 0.2126
    EXPECT_EQ(int(v), 240);       // 128 + 224 / 2
    EXPECT_EQ(int(u), 102);       // 128 - 224 0.2126 / 1.8556
}

TEST(Yuv, KnowsTheCornersOfBt601WhereItIsAsJpeg) {
    const cv::Mat red(2, 2, CV_8UC3, cv::Scalar{0, 0, 255});
    std::array<std::uint8_t, 4> luma{};
    std::uint8_t u = 0, v = 0;
    to_yuv420(red, YuvCoding::jpeg, {Plane{luma.data(), 2}, Plane{&u, 1}, Plane{&v, 1}});
    EXPECT_EQ(int(luma[0]), 76);  // 255 0.299
    EXPECT_EQ(int(v), 255);       // 128 + 255 / 2
    EXPECT_EQ(int(u), 85);        // 128 - 255 0.299 / 1.772
}

TEST(Yuv, RepeatsTheLastRowAndColumnOfColoursToo) {
    cv::Mat image(3, 3, CV_8UC3, cv::Scalar{10, 10, 10});
    image.row(2).setTo(cv::Scalar{60, 60, 60});
    image.col(2).setTo(cv::Scalar{90, 90, 90});
    std::array<std::uint8_t, 16> luma{};
    std::array<std::uint8_t, 4> blue{}, red{};
    to_yuv420(image, YuvCoding::jpeg,
              {Plane{luma.data(), 4}, Plane{blue.data(), 2}, Plane{red.data(), 2}});
    EXPECT_EQ(luma, (std::array<std::uint8_t, 16>{10, 10, 90, 90, 10, 10, 90, 90, 60, 60, 90, 90,
                                                  60, 60, 90, 90}));
    EXPECT_EQ(red, (std::array<std::uint8_t, 4>{128, 128, 128, 128}));
}

TEST(DrawEventsBeside, APartSmallerThanAPixelIsOne) {
    const cv::Mat sensor(4, 6, CV_8UC1);
    const cv::Mat part = part_of(sensor, {.left = .5, .top = 1, .width = .01, .height = .01});
    EXPECT_EQ(part.size(), cv::Size(1, 1));
}

TEST(DrawEventsBeside, ShowsThePartThatTheFrameShows) {
    Frame frame = test::ramp_frame(20, 10, 0, from_us(0));
    frame.event_preview = Array2<float>(40, 60);
    frame.event_preview(31, 47) = 1;
    const ShownPart part{40 / 60., 30 / 40., 10 / 60., 5 / 40.};
    cv::Mat image;
    draw(frame, Uncertainty::none, 1.0f, image);
    draw_events_beside(frame, part, image);
    EXPECT_EQ(image.cols, 40);
    EXPECT_EQ(image.at<cv::Vec3b>(2, 14), cv::Vec3b(60, 60, 220)) << "twice the sensor's size";
    EXPECT_EQ(image.at<cv::Vec3b>(0, 0), cv::Vec3b(255, 255, 255));
}

}  // namespace
}  // namespace eventide
