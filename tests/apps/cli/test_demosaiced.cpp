// Images of sensors with a colour filter: which it is, and demosaiced where they can be.
#include "apps/cli/run/colour.h"
#include "pipeline/demosaiced.h"
#include "tests/io/bag_writer.h"
#include "tests/replay/recording_files.h"

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

TEST(Demosaiced, AnImageIsWhatItSaysUnlessSomebodyStatesSomethingElse) {
    ReferenceImage image = mosaic(4, 6);
    image.filter = ColourFilter::grbg;
    EXPECT_EQ(demosaiced(image, told_filter(ColourFilter::none, false)).channels, 3);
    EXPECT_EQ(demosaiced(image, told_filter(ColourFilter::none, true)), image) << "--bayer none";
    image.pixels(0, 0) = 9000;
    EXPECT_EQ(demosaiced(image, told_filter(ColourFilter::bggr, false)),
              demosaiced(image, ColourFilter::bggr));
    EXPECT_NE(demosaiced(image, ColourFilter::bggr), demosaiced(image, std::nullopt));
}

TEST(ColourFilterOf, ABagIsWhatItsImagesTell) {
    using namespace test;
    constexpr std::uint32_t kEvents = 3, kImages = 5;
    const TestFolder folder;
    RunSettings settings;
    settings.source = folder.write(
        "a.bag",
        bag(chunk("none", connection(kEvents, "dvs_msgs/EventArray") +
                              connection(kImages, "sensor_msgs/Image") +
                              message(kEvents, event_array(6, 4, some_events(9, 0, 1, 6, 4))) +
                              message(kImages, image(mosaic(4, 6), "bayer_grbg8")))));
    const SensorInfo sensor{.name = "", .serial = "", .format = "rosbag", .width = 6, .height = 4};
    const auto filter = [&] {
        return colour_filter_of(settings, source_colours_of(settings, sensor, false), sensor,
                                FilterChain{settings.filter, {6, 4}});
    };
    EXPECT_EQ(filter(), ColourFilter::none) << "nobody asks";
    settings.events_out = "a.aedat4";  // says it in its header
    EXPECT_EQ(filter(), ColourFilter::grbg);
    settings.events_out.clear();
    settings.record = "a.aedat4";
    EXPECT_EQ(filter(), ColourFilter::grbg);
    settings.record.clear();
    settings.colour = true;
    EXPECT_EQ(filter(), ColourFilter::grbg);
    settings.bayer = ColourFilter::bggr;
    EXPECT_EQ(filter(), ColourFilter::bggr) << "as was asked for";
}

}  // namespace
}  // namespace eventide::app
