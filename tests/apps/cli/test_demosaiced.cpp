// Images of sensors with a colour filter, demosaiced where they can be.
#include "apps/cli/run/colour.h"

#include <gtest/gtest.h>

namespace eventide::app {
namespace {

ReferenceImage mosaic(int height, int width) {
    ReferenceImage image;
    image.pixels = Array2<std::uint16_t>(height, width);
    for (std::uint16_t& pixel : image.pixels.values()) pixel = 1000;
    return image;
}

TEST(Demosaiced, IsInColourAndOfTheSameSize) {
    const ReferenceImage colour = demosaiced(mosaic(4, 6), ColourFilter::rggb);
    EXPECT_EQ(colour.channels, 3);
    EXPECT_EQ(colour.filter, ColourFilter::none);
    EXPECT_EQ(colour.pixels.height(), 4);
    EXPECT_EQ(colour.pixels.width(), 18);
    for (const std::uint16_t value : colour.pixels.values()) EXPECT_EQ(value, 1000);
}

TEST(Demosaiced, WhatHasNothingToInterpolateStaysAsItIs) {
    for (const ReferenceImage& thin : {mosaic(1, 6), mosaic(4, 1), mosaic(0, 0)})
        EXPECT_EQ(demosaiced(thin, ColourFilter::rggb), thin);
    EXPECT_EQ(demosaiced(mosaic(4, 6), ColourFilter::none), mosaic(4, 6)) << "no filter is known";
}

}  // namespace
}  // namespace eventide::app
