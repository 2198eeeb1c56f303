// A simulated colour camera: each pixel sees the scene in its colour, and nothing else differs from
// three grey cameras.
#include "src/simulate/colour_recording.h"
#include "src/simulate/scene/textures.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace eventide {
namespace {

constexpr int kWidth = 18, kHeight = 14;

SimRecordingSettings settings() {
    SimRecordingSettings settings;
    const SimulationPreset& preset = simulation_preset("demo");
    settings.scene = preset.scene;
    settings.sensor = preset.sensor;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.seconds = .3;
    settings.images_per_second = 10;
    settings.truths_per_second = 20;
    return settings;
}

struct Recorded {
    std::vector<Event> events;
    std::vector<ReferenceImage> images;
};
void add(const Batch& batch, Recorded& into) {
    into.events.insert(into.events.end(), batch.events.begin(), batch.events.end());
    into.images.insert(into.images.end(), batch.images.begin(), batch.images.end());
}

TEST(ColourRecording, IsWhatGreyCamerasOfEachColourSeeAtTheirPixels) {
    ColourRecording::Textures textures;
    std::array<Recorded, 3> grey;
    std::array<std::size_t, 3> grey_truths{};
    for (std::size_t c = 0; c < 3; ++c) {
        textures[c] = procedural_textures(4, 64, c + 1);
        simulate_recording(settings(), textures[c],
                           [&](const Batch& batch, const std::vector<Truth>& truths) {
                               add(batch, grey[c]);
                               grey_truths[c] += truths.size();
                               return true;
                           });
    }
    constexpr ColourFilter kFilter = ColourFilter::gbrg;
    ColourRecording recording{settings(), textures, kFilter};
    Recorded colour;
    Batch batch;
    ColourRecording::Truths truths;
    std::size_t seen_truths = 0;
    while (recording.next(batch, truths)) {
        add(batch, colour);
        ASSERT_EQ(truths[0].size(), truths[2].size());
        seen_truths += truths[1].size();
    }
    EXPECT_EQ(seen_truths, grey_truths[1]);
    EXPECT_TRUE(std::ranges::is_sorted(colour.events, {}, &Event::t));
    ASSERT_EQ(colour.images.size(), 4U);
    std::size_t expected = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto of_colour = [&](const Event& e) {
            return channel_at(kFilter, e.x, e.y) == ColourChannel(c);
        };
        std::vector<Event> found, wanted;
        std::ranges::copy_if(colour.events, std::back_inserter(found), of_colour);
        std::ranges::copy_if(grey[c].events, std::back_inserter(wanted), of_colour);
        EXPECT_FALSE(wanted.empty());
        EXPECT_EQ(found, wanted);
        expected += wanted.size();
        for (std::size_t i = 0; i < colour.images.size(); ++i) {
            EXPECT_EQ(colour.images[i].filter, kFilter);
            EXPECT_EQ(colour.images[i].t, grey[c].images[i].t);
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x)
                    if (channel_at(kFilter, x, y) == ColourChannel(c)) {
                        ASSERT_EQ(colour.images[i].pixels(y, x), grey[c].images[i].pixels(y, x));
                    }
        }
    }
    EXPECT_EQ(colour.events.size(), expected);
}

}  // namespace
}  // namespace eventide
