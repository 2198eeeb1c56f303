// The moving line: what people watch a run for is there on every terminal of 40 columns and more.
#include "apps/cli/run/fitted_line.h"
#include "apps/cli/run/report/status_line.h"

#include <gtest/gtest.h>

#include <chrono>

namespace eventide::app {
namespace {

using namespace std::chrono_literals;

/// Half of 1000 bytes, 9 s of the sensor's time in 5 s.
Snapshot busy() {
    Snapshot now;
    now.parsed_bytes = 500;
    now.bytes = 1000;
    now.events = 1'234'567;
    now.event_windows = 180;
    now.begin = from_us(1'000'000);
    now.window = {from_us(9'950'000), from_us(10'000'000)};
    now.frames = 270;
    now.lost_packets = 2;
    now.skipped_frames = 3;
    now.damaged.count(DamageReason::unknown_word, 5);
    now.latency.p50 = 12ms;
    now.latency.p99 = 34ms;
    return now;
}

RunProgress of_a_recording() {
    RunProgress progress;
    progress.elapsed = 5s;
    progress.total_bytes = 1000;
    progress.event_rate = 2.5e6;
    return progress;
}

void expect_parts(const std::string& line, std::initializer_list<const char*> parts) {
    for (const char* part : parts)
        EXPECT_NE(line.find(part), std::string::npos) << part << " in " << line;
}

TEST(StatusLine, FitsAnyWidth) {
    Snapshot crowded = busy();
    crowded.lost_packets = crowded.skipped_frames = 123'456'789;
    crowded.damaged.count(DamageReason::unknown_word, 123'456'789);
    crowded.camera.emplace();
    for (std::size_t i = 0; i < kCameraCounts; ++i)
        crowded.camera->set(CameraCount(i), 123'456'789);
    RunProgress live = of_a_recording();
    live.in_step = true;
    for (std::size_t columns = 20; columns <= 200; ++columns)
        for (const Snapshot& now : {busy(), crowded})
            for (const RunProgress& progress : {of_a_recording(), live})
                EXPECT_LE(status_line(now, progress, columns).size(), columns) << columns;
}

TEST(StatusLine, ShowsEverythingWhereThereIsRoom) {
    expect_parts(
        status_line(busy(), of_a_recording(), 160),
        {"[============>           ]  50 %", "1.8x real time", "0:05 left", "2.5 M events/s",
         "window 50.0 ms", "frames 270", "lost 2", "skipped 3", "damaged 5"});
}

TEST(StatusLine, KeepsWhatMattersOnATerminalOf40Columns) {
    expect_parts(status_line(busy(), of_a_recording(), 39),
                 {"50 %", "1.8x", "0:05", "lost 2", "skip 3", "dam 5"});
    RunProgress live;
    live.in_step = true;
    live.elapsed = 5s;
    expect_parts(status_line(busy(), live, 39), {"12/34 ms", "lost 2", "skipped 3", "damaged 5"});
}

TEST(StatusLine, ShowsWhatWentWrongWithTheCamera) {
    Snapshot now = busy();
    now.camera.emplace();
    now.camera->set(CameraCount::transfers, 9);
    EXPECT_EQ(status_line(now, of_a_recording(), 200).find("camera"), std::string::npos);
    now.camera->set(CameraCount::dropped_events, 1'200'000);
    now.camera->set(CameraCount::reconnects, 1);
    expect_parts(status_line(now, of_a_recording(), 200),
                 {"damaged 5  camera: dropped events 1200000, reconnects 1"});
    expect_parts(status_line(now, of_a_recording(), 120), {"damaged 5  camera drop 1.2M back 1"});
    expect_parts(status_line(now, of_a_recording(), 39),
                 {"50 %", "1.8x", "0:05", "lost 2", "skip 3", "dam 5"});
}

TEST(StatusLine, LatencyIsOfRunsInStepWithTheWorldAndSpeedOfTheOthers) {
    RunProgress progress = of_a_recording();
    EXPECT_EQ(status_line(busy(), progress, 160).find("latency"), std::string::npos);
    progress.in_step = true;
    const std::string line = status_line(busy(), progress, 160);
    expect_parts(line, {"latency 12.0/34.0 ms"});
    EXPECT_EQ(line.find("real time"), std::string::npos);
    Snapshot none = busy();
    none.frames = 0;
    EXPECT_EQ(status_line(none, progress, 160).find("latency"), std::string::npos);
}

TEST(StatusLine, TheShareIsOfWhatWasAskedForAndNotOfWhatWasReadAhead) {
    RunProgress progress = of_a_recording();
    EXPECT_DOUBLE_EQ(share_done(busy(), progress), 0.5);
    progress.end = from_us(13'000'000);
    EXPECT_DOUBLE_EQ(share_done(busy(), progress), 0.75) << "9 s of 12";
    progress.end = from_us(1'000'000'000);
    EXPECT_DOUBLE_EQ(share_done(busy(), progress), 0.5) << "the recording ends before";
    RunProgress live;
    live.duration = 90s;
    EXPECT_DOUBLE_EQ(share_done(busy(), live), 0.1);
    EXPECT_EQ(share_done(busy(), {}), 0);
}

TEST(StatusLine, TimeLeftIsToldOnceItCanBe) {
    EXPECT_TRUE(left_part(0.5s, 0.5).empty());
    EXPECT_TRUE(left_part(10s, 0.001).empty());
    EXPECT_EQ(left_part(10s, 0.5).front(), "0:10 left");
    EXPECT_EQ(left_part(3723s, 0.5).front(), "1:02:03 left");
}

}  // namespace
}  // namespace eventide::app
