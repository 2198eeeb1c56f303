// Images before they correct frames: mosaics in grey, and those that make no sense.
#include "library/pushed_images.h"
#include "src/core/bayer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <eventide/error.h>

#include <algorithm>
#include <climits>

namespace eventide {
namespace {

using testing::HasSubstr;

/// What a sensor with this filter sees of one colour.
ReferenceImage mosaic_of(ColourFilter filter, int height, int width) {
    ReferenceImage image;
    image.filter = filter;
    image.pixels = Array2<std::uint16_t>(height, width);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const ColourChannel channel = channel_at(filter, x, y);
            image.pixels(y, x) = channel == ColourChannel::red     ? 60000
                                 : channel == ColourChannel::green ? 20000
                                                                   : 4000;
        }
    return image;
}

TEST(Mosaic, OfOneColourIsOneGreyUpToTheEdges) {
    for (const ColourFilter filter :
         {ColourFilter::rggb, ColourFilter::grbg, ColourFilter::gbrg, ColourFilter::bggr})
        for (const auto& [height, width] : {std::pair{2, 2}, {3, 5}, {8, 7}}) {
            const ReferenceImage grey = without_mosaic(mosaic_of(filter, height, width));
            EXPECT_EQ(grey.filter, ColourFilter::none);
            for (const std::uint16_t value : grey.pixels.values())
                EXPECT_EQ(value, 26000) << height << "x" << width;
        }
}

TEST(Mosaic, GreyIsRoundedToTheNearest) {
    ReferenceImage image;
    image.filter = ColourFilter::rggb;
    image.pixels = Array2<std::uint16_t>(5, 5);
    image.pixels(2, 2) = 6;  // 4, 2 and 1 sixteenths of it: 1.5, .75 and .375
    const ReferenceImage grey = without_mosaic(image);
    EXPECT_EQ(grey.pixels(2, 2), 2);
    EXPECT_EQ(grey.pixels(2, 1), 1);
    EXPECT_EQ(grey.pixels(1, 1), 0);
    std::ranges::fill(image.pixels.values(), std::uint16_t{65535});
    EXPECT_EQ(without_mosaic(image).pixels, image.pixels) << "the brightest there is";
}

TEST(Mosaic, WhatIsNoneStaysAsItIs) {
    ReferenceImage image = mosaic_of(ColourFilter::rggb, 4, 4);
    image.filter = ColourFilter::none;
    EXPECT_EQ(without_mosaic(image), image);
    image = mosaic_of(ColourFilter::rggb, 1, 4);
    EXPECT_EQ(without_mosaic(image), image) << "nothing to mix with";
}

/// As a recording's own images say it, and as files are written and the program reads them.
TEST(Mosaic, APartOfTheSensorHasTheFilterOfTheWhole) {
    std::vector<ReferenceImage> images(4);
    images[1].x0 = 1;
    images[2].channels = 3;
    images[3].filter = ColourFilter::bggr;
    tell_filter(ColourFilter::rggb, images);
    EXPECT_EQ(images[0].filter, ColourFilter::rggb);
    EXPECT_EQ(images[1].filter, ColourFilter::rggb);
    EXPECT_EQ(images[2].filter, ColourFilter::none) << "has colours of its own";
    EXPECT_EQ(images[3].filter, ColourFilter::bggr) << "says so itself";
}

std::string refusal_of(const ReferenceImage& image) {
    try {
        check_image(image);
    } catch (const Error& error) {
        return error.what();
    }
    return "none";
}

TEST(PushedImages, ThatMakeNoSenseAreRefused) {
    ReferenceImage image;
    image.pixels = Array2<std::uint16_t>(4, 6);
    EXPECT_EQ(refusal_of(image), "none");
    EXPECT_EQ(refusal_of({}), "none") << "a time alone";
    image.channels = 4;
    EXPECT_THAT(refusal_of(image), HasSubstr("found 4 channels and rows of 6 numbers"));
    image.channels = 0;
    EXPECT_THAT(refusal_of(image), HasSubstr("found 0 channels"));
    image.channels = 1;
    image.y0 = INT_MIN;
    EXPECT_THAT(refusal_of(image), HasSubstr("found one at 0,-2147483648"));
    image.y0 = 0;
    image.exposure_begin = image.exposure_end = from_us(9);
    EXPECT_EQ(refusal_of(image), "none");
    image.exposure_end = from_us(8);
    EXPECT_THAT(refusal_of(image), HasSubstr("exposure_end not before exposure_begin, found 8 us"));
}

}  // namespace
}  // namespace eventide
