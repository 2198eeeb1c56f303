// sensor_msgs/Image: encodings, byte orders, rows that are longer than the image is wide.
#include "replay/ros/ros_image.h"

#include <gtest/gtest.h>

#include <vector>

namespace eventide {
namespace {

using Values = std::vector<std::uint16_t>;

/// Of a message with these bytes; empty where it gives no image.
Values values_of(RosImage message, const std::vector<int>& numbers) {
    std::vector<std::byte> bytes;
    for (const int number : numbers) bytes.push_back(std::byte(number));
    message.bytes = bytes;
    const auto image = image_of(message);
    if (!image) return {};
    EXPECT_EQ(image->pixels.width(), int(message.width) * image->channels);
    EXPECT_EQ(image->pixels.height(), int(message.height));
    return {image->pixels.values().begin(), image->pixels.values().end()};
}

RosImage message(std::string_view encoding, std::uint32_t width, std::uint32_t height,
                 std::size_t step) {
    RosImage made;
    made.encoding = encoding;
    made.width = width;
    made.height = height;
    made.step = step;
    return made;
}

TEST(RosImage, EightBitsAreScaledToSixteen) {
    for (const char* encoding : {"mono8", "8UC1", "bayer_rggb8"})
        EXPECT_EQ(values_of(message(encoding, 2, 1, 2), {1, 255}), (Values{257, 65535}))
            << encoding;
}

TEST(RosImage, SixteenBitsAreInTheOrderThatTheMessageSays) {
    for (const char* encoding : {"mono16", "16UC1", "bayer_bggr16"}) {
        RosImage little = message(encoding, 2, 1, 4), big = little;
        big.big_endian = true;
        EXPECT_EQ(values_of(little, {1, 2, 3, 4}), (Values{0x0201, 0x0403})) << encoding;
        EXPECT_EQ(values_of(big, {1, 2, 3, 4}), (Values{0x0102, 0x0304})) << encoding;
    }
}

TEST(RosImage, ColoursComeOutAsBlueGreenRed) {
    const auto scaled = [](Values values) {
        for (auto& value : values) value = std::uint16_t(value * 257);
        return values;
    };
    const std::vector<int> three{1, 2, 3, 4, 5, 6}, four{1, 2, 3, 4, 5, 6, 7, 8};
    EXPECT_EQ(values_of(message("bgr8", 2, 1, 6), three), scaled({1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(values_of(message("8UC3", 2, 1, 6), three), scaled({1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(values_of(message("rgb8", 2, 1, 6), three), scaled({3, 2, 1, 6, 5, 4}));
    EXPECT_EQ(values_of(message("bgra8", 2, 1, 8), four), scaled({1, 2, 3, 4, 5, 6, 7, 8}));
    EXPECT_EQ(values_of(message("rgba8", 2, 1, 8), four), scaled({3, 2, 1, 4, 7, 6, 5, 8}));
}

TEST(RosImage, AMosaicSaysItsFilter) {
    for (const auto& [encoding, filter] :
         {std::pair{"bayer_rggb8", ColourFilter::rggb},
          std::pair{"bayer_grbg8", ColourFilter::grbg},
          std::pair{"bayer_gbrg8", ColourFilter::gbrg},
          std::pair{"bayer_bggr8", ColourFilter::bggr}, std::pair{"mono8", ColourFilter::none}}) {
        RosImage one = message(encoding, 1, 1, 1);
        const std::byte pixel{7};
        one.bytes = {&pixel, 1};
        EXPECT_EQ(image_of(one)->filter, filter) << encoding;
    }
}

TEST(RosImage, RowsMayBeLongerThanTheImageIsWide) {
    EXPECT_EQ(values_of(message("mono8", 2, 2, 3), {1, 2, 9, 3, 4}), (Values{257, 514, 771, 1028}))
        << "the last one need not be";
    EXPECT_TRUE(values_of(message("mono8", 2, 2, 3), {1, 2, 9, 3}).empty()) << "a byte short";
    EXPECT_TRUE(values_of(message("mono8", 2, 2, 1), {1, 2, 3, 4}).empty()) << "rows overlap";
}

TEST(RosImage, OtherEncodingsAreNotRead) {
    for (const char* encoding : {"", "32FC1", "yuv422", "bayer_rggb", "MONO8"})
        EXPECT_TRUE(values_of(message(encoding, 1, 1, 8), {1, 2, 3, 4, 5, 6, 7, 8}).empty())
            << encoding;
}

}  // namespace
}  // namespace eventide
