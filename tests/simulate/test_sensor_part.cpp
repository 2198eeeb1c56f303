// A part of a sensor: it must see what the whole one sees there, under the whole one's exposure.
#include "src/core/error.h"
#include "src/simulate/scene/scene_settings.h"
#include "src/simulate/scene/textures.h"
#include "src/simulate/sensor/sensor_settings.h"
#include "src/simulate/simulated_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace eventide {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 96, kHeight = 72;
constexpr SensorPart kPart{24, 20, 40, 31, kWidth, kHeight};

std::shared_ptr<const TextureLibrary> textures() {
    static const std::shared_ptr<const TextureLibrary> kTextures = procedural_textures(15, 128);
    return kTextures;
}

SimulatedStream stream_of(const SensorPart& part, std::uint64_t seed, TargetRule target) {
    SceneSettings scene;
    scene.target = target;
    // Of an ideal sensor nothing is drawn pixel by pixel, so that two can be compared.
    return {scene, SensorSettings::ideal(.2), textures(), part, seed};
}

double mean_of(const Array2<float>& image) {
    double sum = 0;
    for (const float v : image.values()) sum += double(v);
    return sum / double(image.values().size());
}

Array2<float> truth_of(const SimulatedStream& stream, int width, int height) {
    Array2<float> image(height, width);
    stream.truth(stream.now(), image);
    return image;
}

TEST(SensorPart, GivesTheEventsOfTheWholeInItsPlace) {
    std::size_t compared = 0;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        std::vector<Event> of_whole, of_part, cut;
        stream_of(SensorPart::all(kWidth, kHeight), seed, TargetRule::exposed)
            .advance(from_us(200000), of_whole);
        stream_of(kPart, seed, TargetRule::exposed).advance(from_us(200000), of_part);
        for (Event e : of_whole) {
            const int x = e.x - kPart.x0, y = e.y - kPart.y0;
            if (x < 0 || y < 0 || x >= kPart.width || y >= kPart.height) continue;
            e.x = std::uint16_t(x);
            e.y = std::uint16_t(y);
            cut.push_back(e);
        }
        const auto earlier = [](const Event& a, const Event& b) {
            return std::tuple(a.y, a.x, a.t) < std::tuple(b.y, b.x, b.t);
        };
        std::ranges::sort(cut, earlier);
        std::ranges::sort(of_part, earlier);
        ASSERT_EQ(of_part.size(), cut.size());
        // Places are rounded otherwise by up to 1e-5 px, so a crossing may move a little.
        const auto same = [](const Event& a, const Event& b) {
            return a.x == b.x && a.y == b.y && a.polarity == b.polarity &&
                   std::abs(to_us(a.t) - to_us(b.t)) <= 50;
        };
        ASSERT_TRUE(std::ranges::equal(of_part, cut, same)) << seed;
        compared += cut.size();
    }
    EXPECT_GT(compared, 1000U);
}

TEST(SensorPart, ShowsTheWholeTruthInItsPlace) {
    for (const TargetRule target : {TargetRule::texture, TargetRule::exposed})
        for (std::uint64_t seed = 0; seed < 6; ++seed) {
            std::vector<Event> events;
            auto whole = stream_of(SensorPart::all(kWidth, kHeight), seed, target);
            auto part = stream_of(kPart, seed, target);
            whole.advance(from_us(120000), events);
            part.advance(from_us(120000), events);
            const Array2<float> large = truth_of(whole, kWidth, kHeight);
            const Array2<float> small = truth_of(part, kPart.width, kPart.height);
            // A whole sensor is metered by its own pixels, a part by a coarser image of the
            // whole.
            const double tolerance = target == TargetRule::texture ? 1e-3 : .1;
            for (int y = 0; y < kPart.height; ++y)
                for (int x = 0; x < kPart.width; ++x)
                    ASSERT_NEAR(small(y, x), large(kPart.y0 + y, kPart.x0 + x), tolerance) << seed;
        }
}

TEST(SensorPart, MayBeDarkOrBrightWhereAWholeSensorNeverIs) {
    SceneSettings scene;
    scene.target_mean = {.35, .35};
    const auto furthest = [&](const SensorPart& part) {
        double off = 0;
        for (std::uint64_t seed = 0; seed < 40; ++seed) {
            const SimulatedStream stream{scene, SensorSettings::ideal(.2), textures(), part, seed};
            off = std::max(off, std::abs(mean_of(truth_of(stream, part.width, part.height)) - .35));
        }
        return off;
    };
    EXPECT_LT(furthest(SensorPart::all(kPart.width, kPart.height)), .1);
    EXPECT_GT(furthest(kPart), .15);
    EXPECT_GT(furthest({24, kHeight, 60, 0, kWidth, kHeight}), .07) << "of all rows";
    EXPECT_GT(furthest({kWidth, 18, 0, 50, kWidth, kHeight}), .07) << "of all columns";
}

TEST(SensorPart, OutsideTheWholeIsRefused) {
    for (const SensorPart& part :
         {SensorPart{24, 20, 80, 0, kWidth, kHeight}, SensorPart{24, 20, 0, -1, kWidth, kHeight},
          SensorPart{1, 20, 0, 0, kWidth, kHeight}, SensorPart{100, 20, 0, 0, kWidth, kHeight}}) {
        try {
            stream_of(part, 1, TargetRule::texture);
            FAIL() << "not refused";
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), HasSubstr("does not lie in one of 96 x 72"));
        }
    }
}

}  // namespace
}  // namespace eventide
