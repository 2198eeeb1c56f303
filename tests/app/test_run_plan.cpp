// What a user leaves open is chosen as the documentation says.
#include "src/app/run_plan.h"
#include "src/core/error.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

namespace eventide::app {
namespace {

TEST(RunPlan, LookaheadIsNoneForCamerasAndTwoForRecordingsIfTheModelKnowsThem) {
    RunSettings settings;
    ModelConfig model;
    EXPECT_EQ(lookahead_of(settings, model, true), 0);
    EXPECT_EQ(lookahead_of(settings, model, false), 2);
    model.lookaheads = {0, 1};
    EXPECT_EQ(lookahead_of(settings, model, false), 1);
    settings.lookahead = 2;
    EXPECT_EQ(lookahead_of(settings, model, false), 2) << "what is asked for is done";
}

TEST(RunPlan, PicturesComeThirtyASecondOrOneForEachReferenceImage) {
    RunSettings settings;
    ModelConfig model;
    model.window = "50ms";
    const SlicerSettings usual = slicer_of(settings, model, {});
    EXPECT_EQ(usual.width.count(), 50'000);
    EXPECT_EQ(rate_of(settings, usual), (FrameRate{30, 1}));
    settings.window = "aps";
    EXPECT_FALSE(rate_of(settings, slicer_of(settings, model, {})).is_set());
    settings.fps = {false, {1000, 1}};
    EXPECT_EQ(rate_of(settings, slicer_of(settings, model, {})), (FrameRate{1000, 1}));
}

TEST(RunPlan, NominalRateComesFromTheWindowWhereThereIsNoOther) {
    EXPECT_DOUBLE_EQ(nominal_fps({}, parse_window("20ms")), 50);
    EXPECT_DOUBLE_EQ(nominal_fps({30000, 1001}, parse_window("20ms")), 30000.0 / 1001);
    EXPECT_DOUBLE_EQ(nominal_fps({}, parse_window("1000ev")), 30);
}

TEST(RunPlan, WindowsPlayAtTheRecordingsPaceAndFilesAsFastAsTheyGo) {
    RunSettings settings;
    settings.out = {"a/", "b.mp4"};
    EXPECT_EQ(speed_of(settings), 0);
    settings.out.push_back("window");
    EXPECT_EQ(speed_of(settings), 1);
    settings.speed = "0.25";
    EXPECT_EQ(speed_of(settings), 0.25);
    settings.speed = "max";
    EXPECT_EQ(speed_of(settings), 0);
}

TEST(RunPlan, SizesAreFactorsOrPixels) {
    EXPECT_EQ((SizeChoice{2.5, {}}.of({240, 180})), (Size{600, 450}));
    EXPECT_EQ((SizeChoice{1, Size{33, 7}}.of({240, 180})), (Size{33, 7}));
    EXPECT_THROW((SizeChoice{64, {}}.of({1280, 720})), Error);
}

TEST(RunPlan, SpansCountFromTheFirstEvent) {
    const test::TempFolder temp;
    test::write_text(temp / "e.txt", "8 8\n5.0 1 1 1\n9.5 2 2 0\n");
    RunSettings settings;
    settings.source = temp / "e.txt";
    EXPECT_FALSE(span_of(settings, false).begin);
    settings.from = parse_moment("2s");
    settings.warmup = SensorDuration{500'000};
    settings.duration = SensorDuration{1'000'000};
    const Span span = span_of(settings, false);
    EXPECT_EQ(to_us(*span.frames_from), 7'000'000);
    EXPECT_EQ(to_us(*span.begin), 6'500'000);
    EXPECT_EQ(to_us(*span.end), 8'000'000);
    settings.to = parse_moment("2.5s");
    EXPECT_EQ(to_us(*span_of(settings, false).end), 7'500'000);
    settings.to = parse_moment("1s");
    EXPECT_THROW(span_of(settings, false), Error);
    EXPECT_THROW(span_of(settings, true), Error) << "a camera has no --from";
}

}  // namespace
}  // namespace eventide::app
