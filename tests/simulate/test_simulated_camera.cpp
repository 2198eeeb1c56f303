// A simulated camera as a source: names, bytes, silence, stopping.
#include "drivers/simulated/simulated_camera.h"
#include "src/core/error.h"
#include "tests/support/holdings.h"

#include <gtest/gtest.h>

#include <thread>

namespace eventide {
namespace {

Batch read_all(Source& source) {
    Batch batch;
    RawPacket packet;
    const auto parser = source.make_parser();
    while (source.read(packet) == ReadStatus::data) parser->parse(packet.bytes, batch);
    parser->finish(batch);
    EXPECT_EQ(parser->damaged().total(), 0u);
    return batch;
}

TEST(SimulatedName, SaysSceneSizeSeedAndPace) {
    const auto s = parse_simulated_name("sim:wide?seed=7&size=64x48&images=0&speed=2&seconds=1.5");
    EXPECT_EQ(s.scene, "wide");
    EXPECT_EQ(s.recording.seed, 7u);
    EXPECT_EQ(s.recording.width, 64);
    EXPECT_EQ(s.recording.height, 48);
    EXPECT_EQ(s.recording.images_per_second, 0);
    EXPECT_EQ(s.recording.seconds, 1.5);
    EXPECT_EQ(s.speed, 2);
    EXPECT_EQ(parse_simulated_name("sim:").scene, "demo");
    EXPECT_EQ(parse_simulated_name("sim:demo").recording.seconds, 0);
    EXPECT_EQ(parse_simulated_name("sim:demo?speed=max").recording.seconds, 4);
    EXPECT_TRUE(names_simulation("sim:demo"));
    EXPECT_FALSE(names_simulation("simple.aedat4"));
}

TEST(SimulatedName, IsRefusedWhereItMakesNoSense) {
    for (const char* name :
         {"demo", "sim:nothing", "sim:demo?", "sim:demo?seed", "sim:demo?seed=x",
          "sim:demo?size=10", "sim:demo?size=10x", "sim:demo?speed=0", "sim:demo?speed=-1",
          "sim:demo?colour=red", "sim:demo?seconds=0", "sim:demo?seed=1&", "sim:demo?seed=1.5",
          // What no clock can hold, or gives a recording without any event.
          "sim:demo?speed=1e-300", "sim:demo?speed=1e300", "sim:demo?seconds=1e-300"})
        EXPECT_THROW(parse_simulated_name(name), Error) << name;
    EXPECT_THROW(open_simulation("sim:demo?size=1x1"), Error);
    EXPECT_THROW(open_simulation("sim:demo?textures=/nowhere/at/all"), Error);
}

TEST(SimulatedCamera, OpenedAndClosedLeavesNothingBehind) {
    test::expect_nothing_left([] {
        const auto camera = open_simulation("sim:demo?size=40x30&seed=4&images=0");
        for (RawPacket packet; camera->read(packet) != ReadStatus::data;) continue;
        camera->stop();
    });
}

TEST(SimulatedCamera, GivesTheRecordingOfItsSettingsAndEnds) {
    const auto camera = open_simulation("sim:demo?size=40x30&seconds=.5&speed=max&seed=4");
    EXPECT_FALSE(camera->is_live());
    EXPECT_EQ(camera->info().width, 40);
    const Batch read = read_all(*camera);

    auto settings = parse_simulated_name("sim:demo?size=40x30&seconds=.5&speed=max&seed=4");
    Batch expected;
    simulate_recording(
        settings.recording, procedural_textures(SimulatedCamera::kProceduralTextures),
        [&](const Batch& b, const std::vector<Truth>&) {
            expected.events.insert(expected.events.end(), b.events.begin(), b.events.end());
            expected.images.insert(expected.images.end(), b.images.begin(), b.images.end());
            return true;
        });
    EXPECT_GT(read.events.size(), 500u);
    EXPECT_EQ(read.events, expected.events);
    ASSERT_EQ(read.images.size(), 13u);
    for (std::size_t i = 0; i < 13; ++i) {
        EXPECT_EQ(read.images[i].t, expected.images[i].t);
        EXPECT_EQ(read.images[i].pixels, expected.images[i].pixels);
    }
}

TEST(SimulatedCamera, TellsTheTimeThroughItsImagesWhileNothingMoves) {
    const auto camera = open_simulation("sim:demo?size=16x16&seconds=.5&speed=max");
    const auto parser = camera->make_parser();
    RawPacket packet;
    Batch batch;
    while (camera->read(packet) == ReadStatus::data) parser->parse(packet.bytes, batch);
    ASSERT_TRUE(parser->clock());
    EXPECT_GE(to_us(*parser->clock()), 480000);
}

TEST(SimulatedCamera, KeepsPaceAndStopsFromAnyThread) {
    const auto camera = open_simulation("sim:demo?size=16x16");
    EXPECT_TRUE(camera->is_live());
    RawPacket packet;
    EXPECT_NE(camera->read(packet), ReadStatus::end);
    std::thread other{[&] { camera->stop(); }};
    ReadStatus status = ReadStatus::data;
    while (status != ReadStatus::end) status = camera->read(packet);
    other.join();
    EXPECT_EQ(camera->read(packet), ReadStatus::end);
}

}  // namespace
}  // namespace eventide
