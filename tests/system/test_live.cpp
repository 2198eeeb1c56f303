// The built program with a camera on USB: a DAVIS in software, through the real libusb.
#include "tests/drivers/davis_streams.h"
#include "tests/support/preload.h"
#include "tests/system/program_test.h"
#include "tests/system/recorded.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <span>
#include <sstream>

namespace eventide::test {
namespace {

using testing::HasSubstr;
using testing_support::DavisModel;
using testing_support::DavisModelSettings;
using testing_support::UsbTestbed;
using Json = nlohmann::json;

constexpr int kWidth = 64, kHeight = 48;
constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

/// So small that any machine keeps up.
DavisModelSettings small_camera() {
    DavisModelSettings settings;
    settings.sensor.dvs_columns = settings.sensor.aps_columns = kHeight;
    settings.sensor.dvs_rows = settings.sensor.aps_rows = kWidth;
    return settings;
}

SensorTime host_time() {
    return SensorTime{std::chrono::duration_cast<SensorDuration>(
        std::chrono::steady_clock::now().time_since_epoch())};
}

class Live : public ProgramTest {
protected:
    std::shared_ptr<DavisModel> plug_in(const Batch& scene, bool in_real_time) {
        DavisModelSettings settings = small_camera();
        if (in_real_time) settings.now = host_time;
        const auto camera = std::make_shared<DavisModel>(settings);
        camera->show(scene);
        bed_.plug_in(camera);
        return camera;
    }
    /// About 0.3 s.
    static Batch scene() { return davis_scene(small_camera().sensor, {.events = 20'000}); }

    /// False, and a failure with what it said, where it ended before.
    static bool read_frames(Process& process, std::size_t frames) {
        if (process.read_output(frames * kPixels).size() == frames * kPixels) return true;
        ADD_FAILURE() << "ended: " << process.wait().error;
        return false;
    }
    /// Null before the first line.
    Json last_stats() {
        Json last;
        if (!std::filesystem::exists(temp_ / "stats.jsonl")) return last;
        std::istringstream lines{read_text(temp_ / "stats.jsonl")};
        for (std::string line; std::getline(lines, line) && !lines.eof();) last = Json::parse(line);
        return last;
    }

    UsbTestbed bed_;
};

TEST_F(Live, RecordsAllThatTheCameraSent) {
    const Batch seen = scene();
    const auto camera = plug_in(seen, false);
    Process process =
        start({"run", "davis:", "--fps", "50", "--record", "raw.aedat4", "--out", "gray8:-"},
              {.output_to_pipe = true});
    for (bool over = false; !over;) {
        ASSERT_TRUE(read_frames(process, 1));
        bed_.look([&] { over = camera->is_scene_over(); });
    }
    ASSERT_TRUE(read_frames(process, 2));
    process.signal(SIGINT);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    const Batch kept = recorded(temp_ / "raw.aedat4");
    EXPECT_EQ(kept.events, seen.events);
    EXPECT_EQ(kept.images, seen.images);
    EXPECT_EQ(kept.imu.size(), seen.imu.size());
}

TEST_F(Live, UnpluggedItEndsAsADeviceThatWasLostAndItsFilesAreWhole) {
    const Batch seen = scene();
    plug_in(seen, true);
    Process process =
        start({"run", "davis:", "--fps", "50", "--record", "raw.aedat4", "--out", "gray8:-",
               "--out", "video.mp4", "--out", "frames/", "--overload", "skip"},
              {.output_to_pipe = true});
    ASSERT_TRUE(read_frames(process, 8));
    bed_.unplug();
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.error, HasSubstr("was unplugged; --reconnect"));
    const Batch kept = recorded(temp_ / "raw.aedat4");
    ASSERT_GT(kept.events.size(), 1000U);
    EXPECT_TRUE(std::equal(kept.events.begin(), kept.events.end(), seen.events.begin()));
    const auto times = column(temp_ / "frames/timestamps.csv", 2);
    EXPECT_GE(times.size(), 8U);
    EXPECT_EQ(packet_times(temp_ / "video.mp4").size(), times.size());
    EXPECT_TRUE(std::filesystem::exists(temp_ / "frames/run.json"));
}

/// Whether the newest events are those of the scene, later by some time.
bool ends_with(std::span<const Event> events, std::span<const Event> scene) {
    if (events.size() < scene.size()) return false;
    events = events.last(scene.size());
    const SensorDuration shift = events.front().t - scene.front().t;
    return std::ranges::equal(events, scene, [shift](Event now, const Event& then) {
        now.t -= shift;
        return now == then;
    });
}

class LiveReturn : public Live, public testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(StateKeptOrReset, LiveReturn, testing::Bool());

TEST_P(LiveReturn, GoesOnWhenTheCameraComesBack) {
    const bool reset = GetParam();
    const Batch seen = scene();
    plug_in(seen, true);
    std::vector<std::string> arguments{"run",     "davis:",   "--reconnect", "--fps",
                                       "50",      "--record", "raw.aedat4",  "--out",
                                       "gray8:-", "--stats",  "stats.jsonl"};
    // However busy the machine is, the only gap is the cable's.
    arguments.insert(arguments.end(), {"--buffers-packets", "10000", "--latency", "none"});
    if (reset) arguments.push_back("--reset-on-gap");
    Process process = start(arguments, {.output_to_pipe = true});
    ASSERT_TRUE(read_frames(process, 8));
    bed_.unplug();
    ASSERT_TRUE(read_frames(process, 5));  // the frame stays, and time goes on
    plug_in(seen, true);
    // Until all of the second scene is in the recording, and what it began with was encoded: how
    // long that takes is up to the machine, and what was only fetched may be lost to the signal.
    const auto has_all = [&] {
        const Json stats = last_stats();
        return !stats.is_null() && stats["gaps"] == 1 && stats["state_resets"] == (reset ? 1 : 0) &&
               ends_with(recorded_so_far(temp_ / "raw.aedat4").events, seen.events);
    };
    constexpr int kFramesOfAMinute = 3000;
    for (int frames = 0; frames < kFramesOfAMinute && !has_all(); ++frames)
        ASSERT_TRUE(read_frames(process, 1));
    process.signal(SIGINT);
    const Result result = process.wait();
    EXPECT_EQ(result.exit_code, 0) << result.error;
    EXPECT_THAT(result.error, HasSubstr("camera: reconnects 1"));
    const Json stats = last_stats();
    EXPECT_EQ(stats["camera"]["reconnects"], 1);
    EXPECT_EQ(stats["gaps"], 1);
    EXPECT_EQ(stats["state_resets"], reset ? 1 : 0);

    // All of the second scene is at the recording's end, later by the time that went by.
    const Batch kept = recorded(temp_ / "raw.aedat4");
    ASSERT_GT(kept.events.size(), seen.events.size());
    const std::size_t before = kept.events.size() - seen.events.size();
    EXPECT_TRUE(
        std::equal(kept.events.begin(), kept.events.begin() + long(before), seen.events.begin()));
    const SensorDuration shift = kept.events[before].t - seen.events.front().t;
    EXPECT_GT(shift, kept.events[before - 1].t - SensorTime{});
    for (std::size_t i = 0; i < seen.events.size(); ++i)
        ASSERT_EQ(kept.events[before + i].t - shift, seen.events[i].t) << i;
}

TEST_F(Live, BeforeAWallFramesKeepComingAtTheAskedRate) {
    plug_in(davis_scene(small_camera().sensor, {.events = 2'000}), true);
    const Result result = eventide({"run", "davis:", "--fps", "50", "--duration", "1s", "--latency",
                                    "none", "--out", "frames/", "--stats", "stats.jsonl"});
    ASSERT_EQ(result.exit_code, 0) << result.error;
    const auto times = column(temp_ / "frames/timestamps.csv", 2);
    const Json stats = last_stats();
    EXPECT_NEAR(double(times.size() + stats["skipped_frames"].get<std::size_t>()), 50, 2);
    for (std::size_t i = 1; i < times.size(); ++i)
        EXPECT_EQ((times[i] - times[i - 1]) % 20'000, 0) << i;
    // Few of them are of the scene; all the rest is wall.
    EXPECT_GT(stats["silent_windows"].get<int>(), stats["event_windows"].get<int>() * 3 / 4);
}

TEST_F(Live, StrictlyWhatTheCameraItselfDroppedIsLostData) {
    for (const bool strict : {true, false}) {
        DavisModelSettings settings = small_camera();
        settings.fifo_bytes = 4 << 10;
        // Between two looks 2 ms go by: 20,000 events, of which the camera's memory holds 1000.
        settings.now = [t = std::int64_t{0}]() mutable { return from_us(t += 2000); };
        Batch scene = davis_scene(settings.sensor, {.events = 100'000});
        for (std::size_t i = 0; i < scene.events.size(); ++i)
            scene.events[i].t = from_us(std::int64_t(i / 10));
        scene.images.clear();
        scene.imu.clear();
        const auto camera = std::make_shared<DavisModel>(settings);
        camera->show(scene);
        bed_.plug_in(camera);
        std::vector<std::string> arguments{"run",   "davis:", "--fps",   "50",         "--duration",
                                           "200ms", "--out",  "frames/", "--overwrite"};
        if (strict) arguments.push_back("--strict");
        const Result result = eventide(arguments);
        EXPECT_EQ(result.exit_code, strict ? 5 : 0) << result.error;
        EXPECT_THAT(result.error, HasSubstr("camera: dropped events "));
        const Json run = Json::parse(read_text(temp_ / "frames/run.json"));
        EXPECT_GT(run["counters"]["camera"]["dropped_events"], 0);
        bed_.unplug();
    }
}

TEST_F(Live, WhatTheCameraCountsIsToldWhileItRuns) {
    constexpr davis::Register kDroppedLow{davis::mux, 84};
    const auto camera = plug_in(scene(), true);
    Process process =
        start({"run", "davis:", "--fps", "50", "--out", "gray8:-", "--stats", "stats.jsonl"},
              {.output_to_pipe = true});
    ASSERT_TRUE(read_frames(process, 8));
    bed_.look([&] { camera->write({kDroppedLow, 7}); });
    constexpr int kFramesOfAMinute = 3000;
    Json counts;
    for (int frames = 0; frames < kFramesOfAMinute && counts["dropped_events"] != 7; ++frames) {
        ASSERT_TRUE(read_frames(process, 1));
        const Json stats = last_stats();
        if (!stats.is_null()) counts = stats["camera"];
    }
    EXPECT_EQ(counts["dropped_events"], 7);
    EXPECT_GT(counts["transfers"], 0);
    EXPECT_EQ(counts["reconnects"], 0);
    process.signal(SIGINT);
    EXPECT_EQ(process.wait().exit_code, 0);
    EXPECT_EQ(last_stats()["camera"]["dropped_events"], 7) << "none is counted twice";
}

TEST_F(Live, ListsCamerasThatCanBeUsedAndThoseThatCannot) {
    plug_in({}, false);
    const Json usable = Json::parse(eventide({"devices", "--json"}).output);
    ASSERT_EQ(usable.size(), 1U);
    EXPECT_EQ(usable[0]["source"], "davis:00000042");
    EXPECT_EQ(usable[0]["name"], "DAVIS346B");
    EXPECT_EQ(usable[0]["firmware"], "6");
    EXPECT_THAT(usable[0]["logic"].get<std::string>(), testing::StartsWith("18"));
    EXPECT_EQ(usable[0]["usable"], true);

    bed_.unplug();
    DavisModelSettings newer = small_camera();
    newer.logic = 20;
    bed_.plug_in(std::make_shared<DavisModel>(newer));
    const Json unusable = Json::parse(eventide({"devices", "--json"}).output);
    ASSERT_EQ(unusable.size(), 1U);
    EXPECT_EQ(unusable[0]["usable"], false);
    EXPECT_THAT(unusable[0]["problem"].get<std::string>(), HasSubstr("another protocol"));
    const Result refused = eventide({"run", "davis:", "--out", "null"});
    EXPECT_EQ(refused.exit_code, 4);
    EXPECT_THAT(refused.error, HasSubstr("another protocol"));

    bed_.unplug();
    EXPECT_EQ(Json::parse(eventide({"devices", "--json"}).output), Json::array());
    EXPECT_EQ(eventide({"run", "davis:", "--out", "null"}).exit_code, 4);
}

}  // namespace
}  // namespace eventide::test

int main(int argc, char** argv) {
    eventide::testing_support::enter_testbed(argv);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
