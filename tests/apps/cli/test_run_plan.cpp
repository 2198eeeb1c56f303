// What a user leaves open is chosen as the documentation says.
#include "apps/cli/run/run_plan.h"
#include "src/core/error.h"
#include "tests/support/error_of.h"
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

TEST(RunPlan, FramesComeThirtyASecondOrOneForEachReferenceImage) {
    RunSettings settings;
    ModelConfig model;
    model.window = "50ms";
    const SlicerSettings usual = slicer_of(settings, model, {}, true);
    EXPECT_EQ(usual.width.count(), 50'000);
    EXPECT_EQ(rate_of(settings, usual), (FrameRate{30, 1}));
    EXPECT_EQ(video_rate_of(settings, usual), (FrameRate{30, 1}));
    settings.window = "aps";
    EXPECT_FALSE(rate_of(settings, slicer_of(settings, model, {}, false)).is_set());
    settings.fps = {false, {1000, 1}};
    EXPECT_EQ(rate_of(settings, slicer_of(settings, model, {}, false)), (FrameRate{1000, 1}));
}

TEST(RunPlan, RecordingsAreCutByContentAndLiveSourcesAsTheModelWasTrained) {
    RunSettings settings;
    ModelConfig model;
    model.window = "40ms";
    EXPECT_EQ(slicer_of(settings, model, {}, false).rule, WindowRule::content);
    EXPECT_EQ(slicer_of(settings, model, {}, true).rule, WindowRule::duration);
    settings.window = "model";
    EXPECT_EQ(slicer_of(settings, model, {}, false).width.count(), 40'000);
    settings.window = "auto,20ms";
    EXPECT_EQ(slicer_of(settings, model, {}, true).rule, WindowRule::content) << "asked for";
}

TEST(RunPlan, NominalRateComesFromTheWindowWhereThereIsNoOther) {
    EXPECT_DOUBLE_EQ(nominal_fps({}, parse_window("20ms"), 1), 50);
    EXPECT_DOUBLE_EQ(nominal_fps({30000, 1001}, parse_window("20ms"), 1), 30000.0 / 1001);
    EXPECT_DOUBLE_EQ(nominal_fps({}, parse_window("1000ev"), 1), 30);
}

TEST(RunPlan, SlowMotionHasTheRateInTheVideosSeconds) {
    RunSettings settings;
    settings.slow = 10;
    const SlicerSettings slicer = parse_window("20ms");
    EXPECT_EQ(rate_of(settings, slicer), (FrameRate{300, 1}));
    EXPECT_DOUBLE_EQ(nominal_fps(rate_of(settings, slicer), slicer, 10), 30);
    settings.fps = {false, {25, 1}};
    settings.slow = 40;
    EXPECT_EQ(rate_of(settings, slicer), (FrameRate{1000, 1}));
    settings.slow = 0.5;
    EXPECT_EQ(rate_of(settings, slicer), (FrameRate{25, 2})) << "time lapse, too";
    settings.fps = {false, {30000, 1001}};
    EXPECT_EQ(rate_of(settings, slicer), (FrameRate{15000, 1001}));
    settings.slow = 100'000;
    EXPECT_THROW(rate_of(settings, slicer), Error);
    settings.fps = {false, {}};
    EXPECT_FALSE(rate_of(settings, slicer).is_set()) << "one for each window";
    EXPECT_DOUBLE_EQ(nominal_fps({}, slicer, 10), 5);
    settings.out = {"window"};
    settings.slow = 10;
    EXPECT_DOUBLE_EQ(speed_of(settings), 0.1);
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

TEST(RunPlan, OnlyASimulationsImagesAreCalledTruth) {
    SensorInfo sensor;
    EXPECT_EQ(reference_caption(sensor), "reference");
    sensor.name = "DAVIS346";
    EXPECT_EQ(reference_caption(sensor), "APS");
    sensor.name = "simulated demo";
    EXPECT_EQ(reference_caption(sensor), "truth");
}

TEST(RunPlan, LatencyHasABoundForCamerasAndRecordingsWait) {
    RunSettings settings;
    EXPECT_EQ(latency_of(settings, true), std::chrono::milliseconds{250});
    EXPECT_FALSE(latency_of(settings, false));
    settings.latency = "100ms";
    EXPECT_EQ(latency_of(settings, true), std::chrono::milliseconds{100});
    EXPECT_THROW(latency_of(settings, false), Error);
    settings.latency = "none";
    EXPECT_FALSE(latency_of(settings, true));
}

TEST(RunPlan, SizesAreFactorsOrPixels) {
    EXPECT_EQ((SizeChoice{2.5, {}}.of({240, 180})), (Size{600, 450}));
    EXPECT_EQ((SizeChoice{1, Size{33, 7}}.of({240, 180})), (Size{33, 7}));
    EXPECT_THROW((SizeChoice{64, {}}.of({1280, 720})), Error);
}

TEST(RunPlan, APartWarmsUpForASecondUnlessItIsToldWhatWasBefore) {
    const test::TempFolder temp;
    test::write_text(temp / "e.txt", "8 8\n5.0 1 1 1\n9.5 2 2 0\n");
    RunSettings settings;
    settings.source = temp / "e.txt";
    settings.from = parse_time_point("2s");
    EXPECT_EQ(to_us(*span_of(settings, false).begin), 6'000'000);
    settings.from = parse_time_point("0.5s");
    EXPECT_EQ(to_us(*span_of(settings, false).begin), 5'000'000) << "as far as there is any";
    settings.from = parse_time_point("@4000000");
    EXPECT_EQ(to_us(*span_of(settings, false).begin), 4'000'000);
    settings.from = parse_time_point("2s");
    settings.state_in = "state.safetensors";
    EXPECT_EQ(to_us(*span_of(settings, false).begin), 7'000'000);
    settings.state_in = "";
    settings.warmup = SensorDuration{0};
    EXPECT_EQ(to_us(*span_of(settings, false).begin), 7'000'000);
    settings.warmup = {};
    settings.source = "-";  // its first event is not known yet
    settings.from = parse_time_point("@7000000");
    EXPECT_EQ(to_us(*span_of(settings, false).begin), 6'000'000);
}

TEST(RunPlan, OfWhatIsReadOnceADurationCountsFromTheFirstEventThatComes) {
    RunSettings settings;
    settings.source = "-";
    settings.duration = SensorDuration{1'000'000};
    const Span span = span_of(settings, false);
    EXPECT_EQ(span.duration, settings.duration);
    EXPECT_FALSE(span.end);
    EXPECT_EQ(slicer_of(settings, {}, span, false).duration, settings.duration);
    settings.from = parse_time_point("1s");
    EXPECT_THROW(span_of(settings, false), Error);
}

TEST(RunPlan, ADurationCountsFromWhereARunGoesOn) {
    const test::TempFolder temp;
    test::write_text(temp / "e.txt", "8 8\n5.0 1 1 1\n9.5 2 2 0\n");
    RunSettings settings;
    settings.source = temp / "e.txt";
    settings.state_in = "state.safetensors";
    settings.duration = SensorDuration{1'000'000};
    const auto resumed = [&] {
        return resumed_span(settings, span_of(settings, false), from_us(7'000'000));
    };
    EXPECT_EQ(to_us(*resumed().frames_from), 7'000'001);
    EXPECT_EQ(to_us(*resumed().end), 8'000'001);
    settings.to = parse_time_point("2.5s");
    EXPECT_EQ(to_us(*resumed().end), 7'500'000) << "whichever is first";
    settings.to = parse_time_point("4s");
    EXPECT_EQ(to_us(*resumed().end), 8'000'001);
    settings.from = parse_time_point("3s");
    EXPECT_EQ(to_us(*resumed().end), 9'000'000) << "of the frames asked for";
    settings.duration.reset();
    EXPECT_EQ(to_us(*resumed().end), 9'000'000);
}

TEST(RunPlan, AnEndBeforeTheTimeOfAStateIsSaidToBe) {
    const test::TempFolder temp;
    test::write_text(temp / "e.txt", "8 8\n5.0 1 1 1\n9.5 2 2 0\n");
    RunSettings settings;
    settings.source = temp / "e.txt";
    settings.state_in = "state.safetensors";
    const auto resumed = [&] {
        return resumed_span(settings, span_of(settings, false), from_us(7'000'000));
    };
    const std::string message =
        "--state-in state.safetensors: expected --to after the state's time, 7000000 us, found "
        "7000000 us";
    settings.to = parse_time_point("2s");
    EXPECT_EQ(test::error_of(resumed, ErrorKind::usage), message);
    settings.duration = SensorDuration{1'000'000};
    EXPECT_EQ(test::error_of(resumed, ErrorKind::usage), message);
    settings.to = parse_time_point("@7000001");
    EXPECT_EQ(to_us(*resumed().end), 7'000'001);
}

TEST(RunPlan, SpansCountFromTheFirstEvent) {
    const test::TempFolder temp;
    test::write_text(temp / "e.txt", "8 8\n5.0 1 1 1\n9.5 2 2 0\n");
    RunSettings settings;
    settings.source = temp / "e.txt";
    EXPECT_FALSE(span_of(settings, false).begin);
    settings.from = parse_time_point("2s");
    settings.warmup = SensorDuration{500'000};
    settings.duration = SensorDuration{1'000'000};
    const Span span = span_of(settings, false);
    EXPECT_EQ(to_us(*span.frames_from), 7'000'000);
    EXPECT_EQ(to_us(*span.begin), 6'500'000);
    EXPECT_EQ(to_us(*span.end), 8'000'000);
    EXPECT_EQ(to_us(*slicer_of(settings, {}, span, false).begin), 6'499'999)
        << "windows are (begin, end], and the event at --from is asked for";
    settings.warmup = SensorDuration{10'000'000};
    EXPECT_EQ(to_us(*span_of(settings, false).begin), 5'000'000) << "nothing is before the first";
    settings.to = parse_time_point("2.5s");
    EXPECT_EQ(to_us(*span_of(settings, false).end), 7'500'000);
    settings.to = parse_time_point("1s");
    EXPECT_THROW(span_of(settings, false), Error);
    EXPECT_THROW(span_of(settings, true), Error) << "a camera has no --from";
}

}  // namespace
}  // namespace eventide::app
