// The counters of a run, as JSON and as words.
#include "apps/cli/run/report/run_report.h"
#include "apps/cli/terminal.h"
#include "src/core/number_text.h"

#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

namespace eventide::app {
namespace {

Snapshot busy() {
    Snapshot now;
    now.events = 1'234'567;
    now.bytes = 500;
    now.frames = 42;
    now.skipped_frames = 3;
    now.used_images = 30;
    now.dropped_images = 4;
    now.lost_packets = 2;
    now.flicker = {100.5, 100.5, 77};
    now.damaged.count(DamageReason::unknown_word, 5);
    now.window = {from_us(1'000'000), from_us(1'050'000)};
    now.newest_frame = from_us(1'040'000);
    now.latency.p50 = std::chrono::milliseconds{12};
    return now;
}

TEST(RunReport, JsonIsOneLineWithEveryCounter) {
    const std::string line = stats_json(busy(), {}, true);
    EXPECT_EQ(line.find('\n'), std::string::npos);
    const auto json = nlohmann::json::parse(line);
    EXPECT_EQ(json["final"], true);
    EXPECT_EQ(json["events"], 1'234'567);
    EXPECT_EQ(json["lost_packets"], 2);
    EXPECT_EQ(json["used_images"], 30);
    EXPECT_EQ(json["dropped_images"], 4);
    EXPECT_EQ(json["flicker_hz"], 100.5);
    EXPECT_EQ(json["flicker_events"], 77);
    EXPECT_EQ(json["damaged"]["unknown_word"], 5);
    EXPECT_EQ(json["damaged"].size(), kDamageReasons);
    EXPECT_EQ(json["latency_ms"]["p50"], 12.0);
    EXPECT_EQ(json["newest_frame_us"], 1'040'000);
    EXPECT_TRUE(nlohmann::json::parse(stats_json({}, {}, false))["newest_frame_us"].is_null());
    EXPECT_TRUE(nlohmann::json::parse(stats_json({}, {}, false))["flicker_hz"].is_null());
}

TEST(RunReport, EveryCountOfACameraIsInJsonAndWhatWentWrongInTheSummary) {
    EXPECT_TRUE(nlohmann::json::parse(stats_json(busy(), {}, false))["camera"].is_null());
    Snapshot now = busy();
    now.camera.emplace();
    EXPECT_EQ(summary_text(now, {}).find("camera"), std::string::npos);
    for (std::size_t i = 0; i < kCameraCounts; ++i)
        now.camera->set(CameraCount(i), 1000 * std::uint64_t(i + 1));
    const auto json = nlohmann::json::parse(stats_json(now, {}, false))["camera"];
    EXPECT_EQ(json.size(), kCameraCounts);
    EXPECT_EQ(json["transfers"], 1000);
    EXPECT_EQ(json["dropped_events"], 3000);
    EXPECT_EQ(json["reconnects"], 8000);
    EXPECT_TRUE(summary_text(now, {}).ends_with(
        "\ncamera: dropped events 3000, lost transfers 4000, damaged transfers 5000, cut transfers "
        "6000, stalls 7000, reconnects 8000"))
        << summary_text(now, {});
}

TEST(RunReport, JsonNamesAModelWhoseFileNameIsNoUtf8) {
    RunProgress progress;
    progress.quality.emplace();
    progress.quality->model = "./m\xff.safetensors";
    const std::string line = stats_json(busy(), progress, false);
    EXPECT_EQ(line.find('\n'), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(line)["quality"]["model"], "./m\uFFFD.safetensors");
}

TEST(RunReport, SummaryNamesTheReasonsOfDamage) {
    EXPECT_NE(summary_text(busy(), {}).find("unknown_word: 5"), std::string::npos);
}

TEST(RunReport, LatencyIsOfRunsInStepWithTheWorld) {
    EXPECT_EQ(summary_text(busy(), {}).find("latency"), std::string::npos);
    RunProgress live;
    live.in_step = true;
    EXPECT_NE(summary_text(busy(), live).find("latency 12.0/0.0 ms"), std::string::npos);
    Snapshot none = busy();
    none.frames = 0;
    EXPECT_EQ(summary_text(none, live).find("latency"), std::string::npos);
}

TEST(RunReport, TheFinalEventRateIsTheMean) {
    RunProgress progress;
    progress.elapsed = std::chrono::seconds{2};
    progress.event_rate = 5;
    const auto rate = [&](bool final) {
        return nlohmann::json::parse(stats_json(busy(), progress, final))["event_rate"];
    };
    EXPECT_EQ(rate(false), 5.0);
    EXPECT_EQ(rate(true), 617'283.5);
}

TEST(RunReport, ARunWithoutFramesSaysWhy) {
    EXPECT_EQ(why_no_frames(busy()), "");
    Snapshot none;
    EXPECT_NE(why_no_frames(none).find("no event was read"), std::string::npos);
    none.damaged.count(DamageReason::out_of_range, 3);
    EXPECT_NE(why_no_frames(none).find("--input-size"), std::string::npos);
    none.damaged.count(DamageReason::bad_record, 1);
    EXPECT_NE(why_no_frames(none).find("--input-columns"), std::string::npos);
    none.events = none.slicing.before_begin = 7;
    EXPECT_NE(why_no_frames(none).find("before --from"), std::string::npos);
    none.events = 9;
    none.slicing.after_end = 2;
    EXPECT_NE(why_no_frames(none).find("between --from and --to"), std::string::npos);
    none.events = none.filtered_events = 10;
    none.slicing = {};
    EXPECT_NE(why_no_frames(none).find("filters left no event (--noise-filter"), std::string::npos);
    none.slicing.after_end = 4;
    none.filtered_events = 5;  // and one held by a filter to the end
    EXPECT_NE(why_no_frames(none).find("filters left no event between --from and --to"),
              std::string::npos);
    none.window_events = 1;
    EXPECT_NE(why_no_frames(none).find("--fps"), std::string::npos);
}

TEST(RunReport, StrictMeansLossAndDamageAndNotSkippedFrames) {
    Snapshot now;
    now.skipped_frames = 9;
    EXPECT_FALSE(lost_data(now));
    now.camera.emplace();
    now.camera->set(CameraCount::bytes, 9);
    now.camera->set(CameraCount::reconnects, 1);
    EXPECT_FALSE(lost_data(now));
    now.camera->set(CameraCount::lost_transfers, 1);
    EXPECT_TRUE(lost_data(now));
    now.camera.reset();
    EXPECT_FALSE(lost_data(now));
    for (std::uint64_t* count : {&now.gaps, &now.lost_packets, &now.slicing.too_many}) {
        *count = 1;
        EXPECT_TRUE(lost_data(now));
        *count = 0;
    }
    EXPECT_TRUE(lost_data(busy()));
}

TEST(RunReport, TheSummaryCountsTheEventsInEventWindows) {
    // Of 9000 parsed, 5000 are a filter's and 1900 lie behind --to.
    Snapshot part;
    part.frames = 3;
    part.events = 9000;
    part.filtered_events = 5000;
    part.slicing.after_end = 1900;
    part.window_events = 2100;
    EXPECT_TRUE(summary_text(part, {}).starts_with("3 frames from 2.1 k events in"));
}

TEST(RunReport, OneIsOneFrame) {
    Snapshot one;
    one.frames = one.window_events = 1;
    EXPECT_TRUE(summary_text(one, {}).starts_with("1 frame from 1 event in"));
    EXPECT_TRUE(summary_text({}, {}).starts_with("0 frames from 0 events in"));
    EXPECT_EQ(counted(1, "IMU sample"), "1 IMU sample");
    EXPECT_EQ(counted(11, "image"), "11 images");
}

TEST(RunReport, ShortCountsKeepTheirSize) {
    EXPECT_EQ(short_count(0), "0");
    EXPECT_EQ(short_count(999), "999");
    EXPECT_EQ(short_count(1234), "1.2 k");
    EXPECT_EQ(short_count(99'970), "100 k");
    EXPECT_EQ(short_count(999'700), "1.0 M");
    EXPECT_EQ(short_count(123.4e6), "123 M");
}

}  // namespace
}  // namespace eventide::app
