// An image of a scene that stands still is what frames show, for as long as it does.
#include "tests/model/fused_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace eventide {
namespace {

using namespace test;
using Kind = GridStream::Kind;

/// Root of the mean square.
double error_of(const Frame& frame, const Array2<float>& truth) {
    double squares = 0;
    for (std::size_t i = 0; i < truth.values().size(); ++i)
        squares += std::pow(double(frame.intensity.values()[i]) - double(truth.values()[i]), 2);
    return std::sqrt(squares / double(truth.values().size()));
}

/// Events of so many windows, and an image at the end of window `taken` that is there for the
/// window `given`.
struct Scene {
    int moves, stands, moves_again;
    int taken, given;
};

/// The ends of its windows.
std::vector<SensorTime> show(const Scene& scene, FusedChain& chain) {
    std::vector<SensorTime> ends;
    for (int i = 0; i < scene.moves + scene.stands + scene.moves_again; ++i) {
        const bool moves = i < scene.moves || i >= scene.moves + scene.stands;
        ends.push_back(chain.encode_next(moves ? Kind::patch : Kind::silence).end);
        if (i == 0) chain.fused.give(image_of(constant(.5F), ends[0]));
        if (i == scene.given) chain.fused.give(image_of(ramp(), ends[std::size_t(scene.taken)]));
        chain.push(moves ? .01F : 0.F);
    }
    return ends;
}

TEST(FusedSilence, EndsWithTheWindowInWhichTheSceneMoves) {
    for (const int lookahead : {0, 1, 2}) {
        FusedChain chain{lookahead};
        const auto ends = show({5, 7, lookahead, 8, 8}, chain);
        EXPECT_LT(error_of(chain.shown(ends[11]), ramp()), .06)
            << "lookahead " << lookahead << ": it reads what comes after";
    }
}

TEST(FusedSilence, GoesOnToTheEndOfAStream) {
    for (const int lookahead : {0, 1, 2}) {
        FusedChain chain{lookahead};
        const auto ends = show({5, 7, 0, 8, 8}, chain);
        chain.renderer.finish();
        EXPECT_LT(error_of(chain.shown(ends[11]), ramp()), .06)
            << "lookahead " << lookahead << ": it reads what never came";
    }
}

TEST(FusedSilence, BeginsWithTheFirstWindowWithoutEvents) {
    FusedChain chain{0};
    const auto ends = show({5, 1, 0, 4, 4}, chain);
    EXPECT_LT(error_of(chain.shown(ends[5]), ramp()), .02);
}

TEST(FusedSilence, IsCorrectedByAnImageThatIsLate) {
    FusedChain chain{0};
    const auto ends = show({5, 5, 0, 4, 6}, chain);
    EXPECT_LT(error_of(chain.shown(ends[9]), ramp()), .02);
}

TEST(FusedSilence, OfANetworkThatForgetsShowsTheImageAllTheSame) {
    FusedChain chain{0, thesis_config()};
    const auto ends = show({5, 25, 0, 8, 8}, chain);
    EXPECT_LT(error_of(chain.shown(ends[29]), ramp()), .02);
}

}  // namespace
}  // namespace eventide
