// Recordings from the simulator: order, completeness, images at their times.
#include "src/core/error.h"
#include "src/simulate/sim_recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace eventide {
namespace {

std::shared_ptr<const TextureLibrary> textures() {
    static const std::shared_ptr<const TextureLibrary> kTextures = procedural_textures(5, 64);
    return kTextures;
}

SimRecordingSettings small() {
    SimRecordingSettings settings;
    settings.scene = simulation_preset("demo").scene;
    settings.sensor = simulation_preset("demo").sensor;
    settings.width = 40;
    settings.height = 30;
    settings.seconds = .5;
    settings.images_per_second = 30;
    return settings;
}

struct Whole {
    Batch batch;
    std::vector<Truth> truths;
};
Whole record(const SimRecordingSettings& settings) {
    Whole whole;
    simulate_recording(settings, textures(), [&](const Batch& b, const std::vector<Truth>& truths) {
        whole.batch.events.insert(whole.batch.events.end(), b.events.begin(), b.events.end());
        whole.batch.images.insert(whole.batch.images.end(), b.images.begin(), b.images.end());
        whole.truths.insert(whole.truths.end(), truths.begin(), truths.end());
        return true;
    });
    return whole;
}

TEST(SimRecording, HasItsImagesAtEqualTimesFromTheFirstMicrosecondToTheLast) {
    const Whole whole = record(small());
    ASSERT_EQ(whole.batch.images.size(), 16u);
    for (std::size_t i = 0; i < 16; ++i)
        EXPECT_EQ(to_us(whole.batch.images[i].t), std::llround(double(i) * 1e6 / 30));
    EXPECT_TRUE(std::ranges::is_sorted(whole.batch.events, {}, &Event::t));
    EXPECT_LE(to_us(whole.batch.events.back().t), 500000);
    EXPECT_GT(whole.batch.events.size(), 500u);
}

TEST(SimRecording, DoesNotDependOnTheLengthOfItsChunks) {
    SimRecordingSettings settings = small();
    const Whole whole = record(settings);
    settings.chunk = SensorDuration{777};
    const Whole pieces = record(settings);
    EXPECT_EQ(whole.batch.events, pieces.batch.events);
    EXPECT_EQ(whole.batch.images, pieces.batch.images);
}

TEST(SimRecording, EveryImageComesAfterTheEventsBeforeIt) {
    SensorTime newest{};
    simulate_recording(small(), textures(), [&](const Batch& batch, const std::vector<Truth>&) {
        for (const Event& event : batch.events) {
            EXPECT_GT(event.t, newest);
            EXPECT_TRUE(batch.images.empty() || event.t <= batch.images.back().t);
        }
        if (!batch.images.empty()) newest = batch.images.back().t;
        return true;
    });
}

TEST(SimRecording, GivesTruthMoreOftenAndLargerWithoutChangingTheRest) {
    SimRecordingSettings settings = small();
    const Whole plain = record(settings);
    settings.truths_per_second = 90;
    settings.truth_scale = 2.5;
    const Whole more = record(settings);
    EXPECT_EQ(plain.batch.events, more.batch.events);
    EXPECT_EQ(plain.batch.images, more.batch.images);
    ASSERT_EQ(more.truths.size(), 46u);
    const Truth& third = more.truths[3];
    EXPECT_EQ(third.t, more.batch.images[1].t);
    EXPECT_EQ(third.image.width(), 99);
    EXPECT_EQ(third.image.height(), 74);
    for (const int x : {0, 98})  // corners are corners at every scale
        EXPECT_NEAR(third.image(73, x), float(more.batch.images[1].pixels(29, x * 39 / 98)) / 65535,
                    .1);
}

TEST(SimRecording, WhatIsOfItsBeginComesAloneAlsoWhereThatIsTruthAlone) {
    SimRecordingSettings settings = small();
    settings.images_per_second = 0;
    settings.truths_per_second = 25;
    SimRecording recording{settings, textures()};
    Batch batch;
    std::vector<Truth> truths;
    ASSERT_TRUE(recording.next(batch, truths));
    EXPECT_TRUE(batch.empty());
    ASSERT_EQ(truths.size(), 1U);
    EXPECT_EQ(truths[0].t, SensorTime{});
    EXPECT_EQ(recording.now(), SensorTime{});
}

TEST(SimRecording, BeginsAtTheTimeAskedFor) {
    SimRecordingSettings settings = small();
    const Whole at_zero = record(settings);
    settings.begin = from_us(1'700'000'000'000'000);
    Whole later = record(settings);
    EXPECT_EQ(later.batch.images.front().t, settings.begin);
    for (Event& event : later.batch.events) event.t -= settings.begin.time_since_epoch();
    EXPECT_EQ(later.batch.events, at_zero.batch.events);
}

TEST(SimRecording, StopsWhenToldToAndRunsOnWithoutAnEnd) {
    SimRecordingSettings settings = small();
    settings.seconds = 0;
    int batches = 0;
    simulate_recording(settings, textures(),
                       [&](const Batch&, const std::vector<Truth>&) { return ++batches < 100; });
    EXPECT_EQ(batches, 100);
}

TEST(SimRecording, OfOneImageInMoreTimeThanThereIsHasEventsAllTheSame) {
    SimRecordingSettings settings = small();
    settings.images_per_second = 1e-300;
    const Whole whole = record(settings);
    EXPECT_EQ(whole.batch.images.size(), 1u) << "that of its first microsecond";
    settings.images_per_second = 0;
    EXPECT_EQ(whole.batch.events, record(settings).batch.events);
}

TEST(SimRecording, OfTheDemoMovesAndPausesInItsFourSeconds) {
    const SimulationPreset& demo = simulation_preset("demo");
    SimRecordingSettings settings = small();
    settings.scene = demo.scene;
    settings.sensor = demo.sensor;
    settings.seed = demo.seed;
    settings.seconds = 4;
    const Whole whole = record(settings);
    std::vector<int> events(40);
    for (const Event& e : whole.batch.events) ++events[std::size_t((to_us(e.t) - 1) / 100000)];
    const auto quiet = std::ranges::count_if(events, [](int n) { return n < 40 * 30 / 50; });
    EXPECT_GE(quiet, 4);
    EXPECT_LE(quiet, 12);
}

TEST(SimRecording, RefusesSettingsOutOfRangeByName) {
    for (const auto& spoil : std::vector<void (*)(SimRecordingSettings&)>{
             [](SimRecordingSettings& s) { s.width = 1; },
             [](SimRecordingSettings& s) { s.height = 100000; },
             [](SimRecordingSettings& s) { s.seconds = -1; },
             [](SimRecordingSettings& s) { s.seconds = std::numeric_limits<double>::quiet_NaN(); },
             [](SimRecordingSettings& s) { s.seconds = std::numeric_limits<double>::infinity(); },
             [](SimRecordingSettings& s) { s.seconds = 1e13; },
             [](SimRecordingSettings& s) { s.images_per_second = 1e9; },
             [](SimRecordingSettings& s) { s.truth_scale = 0; },
             [](SimRecordingSettings& s) { s.chunk = SensorDuration{0}; }}) {
        SimRecordingSettings settings = small();
        spoil(settings);
        EXPECT_THROW(record(settings), Error);
    }
}

}  // namespace
}  // namespace eventide
