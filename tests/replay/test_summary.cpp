// What a recording holds is counted.
#include "replay/summary.h"

#include "replay/formats.h"
#include "replay/recording_file.h"
#include "tests/replay/recording_files.h"
#include "tests/support/flickering_light.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sstream>

namespace eventide::test {
namespace {

std::string as_text(const std::vector<Event>& events) {
    std::ostringstream text;
    text << "32 24\n";
    for (const Event& event : events)
        text << to_us(event.t) << "e-6 " << event.x << ' ' << event.y << ' '
             << (event.polarity == Polarity::on) << '\n';
    return text.str();
}

TEST(Summary, IsOneObjectWithTheKnownKeys) {
    const TestFolder folder;
    const auto sum = summarize(
        *open_recording(folder.write("a.txt", "240 180\n0.1 1 2 1\n0.2 1 2 0\njunk\n0.3 1 2 1\n")));
    const auto json = nlohmann::json::parse(to_json(sum));
    EXPECT_EQ(json.size(), 14U);
    EXPECT_EQ(json["format"], "text");
    EXPECT_EQ(json["width"], 240);
    EXPECT_EQ(json["height"], 180);
    EXPECT_EQ(json["events"], 3);
    EXPECT_EQ(json["on"], 2);
    EXPECT_EQ(json["first_us"], 100000);
    EXPECT_EQ(json["last_us"], 300000);
    EXPECT_EQ(json["clock_resets"], 0);
    EXPECT_EQ(json["frames"], 0);
    EXPECT_EQ(json["imu"], 0);
    EXPECT_EQ(json["triggers"], 0);
    EXPECT_TRUE(json["flicker_hz"].is_null());
    EXPECT_EQ(json["in_flicker"], 0);
    EXPECT_EQ(json["damaged"]["bad_record"], 1);
    EXPECT_TRUE(nlohmann::json::parse(to_json({}))["first_us"].is_null());
}

TEST(Summary, CountsImagesSamplesAndTriggers) {
    const TestFolder folder;
    StreamHeader header;
    header.width = header.height = 128;
    RecordingFile file(folder.path("a.aedat4"), OutputOptions{}, *find_format("aedat4"), header);
    Batch batch;
    batch.events = some_events(100, 1'000'000);
    ReferenceImage image;
    image.t = image.exposure_begin = image.exposure_end = from_us(1'000'000);
    image.pixels = Array2<std::uint16_t>(128, 128);
    for (int i = 0; i < 2; ++i) batch.add_image(image);
    for (int i = 0; i < 3; ++i) batch.imu.emplace_back().t = from_us(1'000'000 + i);
    for (int i = 0; i < 4; ++i)
        batch.triggers.push_back({from_us(1'000'000 + i), Trigger::Kind::rising, 0});
    file.write(batch);
    file.finish();
    const Summary sum = summarize(*open_recording(folder.path("a.aedat4")));
    EXPECT_EQ(sum.events, 100U);
    EXPECT_EQ(sum.frames, 2U);
    EXPECT_EQ(sum.imu, 3U);
    EXPECT_EQ(sum.triggers, 4U);
}

/// Of whoever waits no longer.
TEST(Summary, StopsWhereItIsTold) {
    const TestFolder folder;
    const auto recording = open_recording(folder.write("a.txt", as_text(some_events(50'000, 0))));
    int calls = 0;
    const Summary sum = summarize(*recording, [&] { return ++calls < 2; });
    EXPECT_EQ(calls, 2);
    EXPECT_LT(sum.events, 50'000U);
    EXPECT_GT(sum.events, 0U);
}

TEST(Summary, GoesOnWhereTheClockBeginsAnew) {
    const TestFolder folder;
    const auto open = [&](const std::vector<Event>& events, std::vector<Trigger> triggers) {
        StreamHeader header;
        header.width = header.height = 128;
        RecordingFile file(folder.path("a.aedat4"), OutputOptions{.overwrite = true},
                           *find_format("aedat4"), header);
        Batch batch;
        batch.events = events;
        batch.triggers = std::move(triggers);
        file.write(batch);
        file.finish();
        return open_recording(folder.path("a.aedat4"));
    };
    auto events = some_events(1000, 60'000'000);
    const SensorDuration once = events.back().t - events.front().t;
    const Summary steady = summarize(*open(events, {}));
    EXPECT_EQ(steady.span, once);
    EXPECT_EQ(steady.clock_resets, 0U);
    const auto again = some_events(1000, 5'000);
    events.insert(events.end(), again.begin(), again.end());
    const Summary sum =
        summarize(*open(events, {{again.front().t, Trigger::Kind::timestamp_reset, 0}}));
    EXPECT_EQ(sum.events, 2000U);
    EXPECT_EQ(sum.clock_resets, 1U);
    EXPECT_EQ(nlohmann::json::parse(to_json(sum))["clock_resets"], 1);
    EXPECT_EQ(sum.span, once + (again.back().t - again.front().t));
}

TEST(Summary, TellsFlickeringLight) {
    const TestFolder folder;
    const auto lamp = lamp_events({.hz = 100, .seconds = 1});
    const Summary sum = summarize(*open_recording(folder.write("a.txt", as_text(lamp))));
    EXPECT_NEAR(sum.flicker_hz, 100, 2);
    EXPECT_GT(sum.in_flicker, lamp.size() / 2);
    EXPECT_LT(sum.in_flicker, sum.events);
}

TEST(Summary, TellsNoFlickerWhereThingsOnlyMove) {
    const TestFolder folder;
    const auto bar = bar_events(32, 24, .5, 1000);
    const Summary sum = summarize(*open_recording(folder.write("a.txt", as_text(bar))));
    EXPECT_EQ(sum.in_flicker, 0U);
    EXPECT_EQ(sum.events, bar.size());
}

}  // namespace
}  // namespace eventide::test
