// Where on the sensor a frame lies that was cut out, cropped and flipped.
#include "apps/cli/run/sink_geometry.h"

#include <gtest/gtest.h>

namespace eventide::app {
namespace {

constexpr Size kSensor{40, 20};

void expect_part(const ShownPart& part, double left, double top, double width, double height) {
    EXPECT_DOUBLE_EQ(part.left, left);
    EXPECT_DOUBLE_EQ(part.top, top);
    EXPECT_DOUBLE_EQ(part.width, width);
    EXPECT_DOUBLE_EQ(part.height, height);
}

TEST(SinkGeometry, ARegionIsInPixelsOfTheFrame) {
    RunSettings settings;
    settings.size.scale = 2;
    expect_part(shown_part(settings, kSensor), 0, 0, 1, 1);
    settings.region = Region{20, 10, 40, 0};
    expect_part(shown_part(settings, kSensor), .25, .25, .5, .75);
    expect_part(rendered_part(settings, kSensor, {}), .25, .25, .5, .75);
}

TEST(SinkGeometry, ACropTakesAsManyPixelsAtEachSide) {
    RunSettings settings;
    settings.adjust.crop_px = 2;
    expect_part(shown_part(settings, kSensor), .05, .1, .9, .8);
    expect_part(rendered_part(settings, kSensor, {}), 0, 0, 1, 1);
}

TEST(SinkGeometry, AFlippedFrameShowsTheOtherSide) {
    RunSettings settings;
    settings.region = Region{0, 0, 10, 5};
    settings.adjust.flip = Flip::horizontal;
    expect_part(shown_part(settings, kSensor), .75, 0, .25, .25);
    settings.adjust.flip = Flip::vertical;
    expect_part(shown_part(settings, kSensor), 0, .75, .25, .25);
    settings.adjust.flip = Flip::both;
    expect_part(shown_part(settings, kSensor), .75, .75, .25, .25);
}

TEST(SinkGeometry, CameraInfoCountsPixelsOfTheWholeFrame) {
    RunSettings settings;
    settings.size.scale = 2;
    settings.region = Region{20, 10, 40, 20};
    settings.adjust.crop_px = 3;
    settings.adjust.flip = Flip::vertical;
    const ImageGeometry geometry = image_geometry(settings, kSensor);
    EXPECT_EQ(geometry.width, 80);
    EXPECT_EQ(geometry.height, 40);
    EXPECT_EQ(geometry.left, 23);
    EXPECT_EQ(geometry.top, 13);
    EXPECT_EQ(geometry.flip, Flip::vertical);
}

}  // namespace
}  // namespace eventide::app
