// Networks that see a scene mirrored, and the mean of their frames.
#include "src/core/error.h"
#include "src/model/encode/encoder.h"
#include "src/model/mirrors.h"
#include "src/model/render/renderer.h"
#include "tests/model/streams.h"
#include "tests/support/error_of.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

constexpr int kWidth = 41, kHeight = 30;

EngineOptions of(int views, Engine engine = Engine::fast) {
    EngineOptions options;
    options.engine = engine;
    options.precision = Precision::f32;
    options.self_ensemble = views;
    return options;
}

/// An encoder and its renderer.
struct Network {
    Network(const Model& model, const EngineOptions& options)
        : encoder(model, kWidth, kHeight, options),
          renderer(model, kWidth, kHeight, options),
          latent(encoder.make_output()) {}
    void see(const VoxelGrid& grid) {
        encoder.encode(grid, latent);
        renderer.take(latent);
    }
    Frame shown(RenderRequest request) {
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        return frame;
    }
    Encoder encoder;
    Renderer renderer;
    LatentMap latent;
};

class SelfEnsemble : public testing::Test {
protected:
    VoxelGrid seen_mirrored(const VoxelGrid& grid, Mirror axes) const {
        VoxelGrid mirrored = grid;
        mirror(grid, axes, mirrored);
        return mirrored;
    }
    /// Within the newest window, larger than the sensor.
    RenderRequest request() const {
        RenderRequest request;
        request.t = stream_end_ - SensorDuration{20'000};
        request.width = 2 * kWidth;
        request.height = kHeight + 7;
        return request;
    }
    const VoxelGrid& next() {
        const VoxelGrid& grid = stream_.next();
        stream_end_ = grid.window.end;
        return grid;
    }

    ModelConfig config_ = test::small_config();
    Model model_ = test::random_model(config_, 2);
    test::GridStream stream_{config_, kHeight, kWidth, 1};
    SensorTime stream_end_{};
};

double worst(const Array2<float>& a, const Array2<float>& b) {
    double worst = 0;
    for (std::size_t i = 0; i < a.values().size(); ++i)
        worst = std::max(worst, double(std::abs(a.values()[i] - b.values()[i])));
    return worst;
}

TEST_F(SelfEnsemble, GivesTheMeanOfNetworksThatSeeTheSceneMirrored) {
    for (const Engine engine : {Engine::fast, Engine::plain})
        for (const int views : {2, 4}) {
            Network together{model_, of(views, engine)};
            std::vector<Network> apart;
            for (int view = 0; view < views; ++view) apart.emplace_back(model_, of(1, engine));
            for (int i = 0; i < 4; ++i) {
                const VoxelGrid& grid = next();
                together.see(grid);
                for (std::size_t view = 0; view < apart.size(); ++view)
                    apart[view].see(seen_mirrored(grid, kMirrors[view]));
            }
            const Frame found = together.shown(request());
            Array2<float> mu(found.intensity.height(), found.intensity.width()), sigma = mu;
            for (std::size_t view = 0; view < apart.size(); ++view) {
                Frame one = apart[view].shown(request());
                mirror(one.intensity, kMirrors[view]);
                mirror(one.sigma, kMirrors[view]);
                for (std::size_t i = 0; i < mu.values().size(); ++i) {
                    const float s = one.sigma.values()[i];
                    mu.values()[i] += one.intensity.values()[i] / float(views);
                    sigma.values()[i] += s * s / float(views);
                }
            }
            for (float& s : sigma.values()) s = float(error_of_mean(views)) * std::sqrt(s);
            EXPECT_LT(worst(found.intensity, mu), 1e-6) << views;
            EXPECT_LT(worst(found.sigma, sigma), 1e-6) << views;
        }
}

/// Whoever fills grids keeps track of touched pixels now and then.
TEST_F(SelfEnsemble, TakesGridsThatTellTouchedPixelsAndOthersInTurn) {
    Network told{model_, of(4)}, searching{model_, of(4)};
    for (int i = 0; i < 6; ++i) {
        VoxelGrid grid = next();
        VoxelGrid untold = grid;
        untold.touched = {};
        told.see(i % 2 == 0 ? untold : grid);
        searching.see(untold);
        EXPECT_EQ(told.shown(request()).intensity, searching.shown(request()).intensity) << i;
    }
}

/// What no single network does.
TEST_F(SelfEnsemble, OfAMirroredSceneIsTheMirroredFrame) {
    const auto difference = [this](int views, Mirror axes) {
        Network as_it_is{model_, of(views)}, mirrored{model_, of(views)};
        for (int i = 0; i < 4; ++i) {
            const VoxelGrid& grid = next();
            as_it_is.see(grid);
            mirrored.see(seen_mirrored(grid, axes));
        }
        const Frame a = as_it_is.shown(request());
        Frame b = mirrored.shown(request());
        mirror(b.intensity, axes);
        return worst(a.intensity, b.intensity);
    };
    for (const Mirror axes : kMirrors) EXPECT_LT(difference(4, axes), 1e-5);
    EXPECT_LT(difference(2, {true, true}), 1e-5);
    EXPECT_GT(difference(2, {true, false}), 1e-3) << "the test sees what is not alike";
    EXPECT_GT(difference(1, {true, true}), 1e-3);
}

TEST_F(SelfEnsemble, ARegionIsAPartOfTheWhole) {
    Network network{model_, of(4)};
    for (int i = 0; i < 3; ++i) network.see(next());
    const Frame whole = network.shown(request());
    RenderRequest part = request();
    part.region = {11, 7, 40, 0};
    const Frame shown = network.shown(part);
    ASSERT_EQ(shown.intensity.height(), kHeight);
    for (int y = 0; y < shown.intensity.height(); ++y)
        for (int x = 0; x < 40; ++x) {
            ASSERT_EQ(shown.intensity(y, x), whole.intensity(y + 7, x + 11));
            ASSERT_EQ(shown.sigma(y, x), whole.sigma(y + 7, x + 11));
        }
}

TEST_F(SelfEnsemble, ResetForgetsInEveryView) {
    Network used{model_, of(4)}, fresh{model_, of(4)};
    for (int i = 0; i < 3; ++i) used.see(next());
    used.encoder.reset();
    used.renderer.reset();
    for (int i = 0; i < 2; ++i) {
        const VoxelGrid& grid = next();
        used.see(grid);
        fresh.see(grid);
    }
    EXPECT_EQ(used.shown(request()).intensity, fresh.shown(request()).intensity);
}

TEST_F(SelfEnsemble, GoesOnFromAState) {
    Network first{model_, of(2)}, second{model_, of(2)}, one{model_, of(1)};
    for (int i = 0; i < 3; ++i) first.see(next());
    second.encoder.restore(first.encoder.state(), "state");
    for (int i = 0; i < 3; ++i) {
        const VoxelGrid& grid = next();
        first.encoder.encode(grid, first.latent);
        second.encoder.encode(grid, second.latent);
    }
    EXPECT_EQ(first.latent.values, second.latent.values);
    EXPECT_EQ(first.latent.mirrored[0].values, second.latent.mirrored[0].values);
    const auto refused = [](Network& by, const Network& from) {
        return test::error_of([&] { by.encoder.restore(from.encoder.state(), "s"); },
                              ErrorKind::input);
    };
    EXPECT_EQ(refused(one, first), "s: state of a self-ensemble: expected 1 network, found 2");
    EXPECT_EQ(refused(first, one), "s: state of a self-ensemble: expected 2 networks, found 1");
}

TEST_F(SelfEnsemble, HasOneTwoOrFourViews) {
    for (const int views : {0, 3, 5, -1}) {
        EXPECT_THROW((Encoder{model_, kWidth, kHeight, of(views)}), Error) << views;
        EXPECT_THROW((Renderer{model_, kWidth, kHeight, of(views)}), Error) << views;
    }
}

}  // namespace
}  // namespace eventide
