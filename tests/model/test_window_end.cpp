// What a window shows at its end, kept for the frames of the next: never another bit, whatever was
// rendered before, in whatever order.
#include "src/model/render/renderer.h"
#include "src/model/render/window_end.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace eventide {
namespace {

constexpr SensorDuration kWindow{50'000};
constexpr int kWidth = 96, kHeight = 64;

bool same(const Array2<float>& a, const Array2<float>& b) {
    return std::ranges::equal(a.values(), b.values());
}

TEST(WindowEnd, ATileIsOfOneWindow) {
    WindowEnd end;
    end.make_room({.part_width = 8, .part_height = 6}, 2);
    ASSERT_TRUE(end.is_kept());
    EXPECT_FALSE(end.holds(0, 1));
    end.note(0, 3);
    EXPECT_TRUE(end.holds(0, 3));
    EXPECT_FALSE(end.holds(0, 2));
    EXPECT_FALSE(end.holds(1, 3)) << "another tile";
    EXPECT_EQ(end.mu(5) - end.mu(0), 40);
    EXPECT_EQ(end.log_sigma(5) - end.log_sigma(0), 40);
    end.reset();
    EXPECT_FALSE(end.holds(0, 3));
    end.note(0, 3);
    end.make_room({.part_width = 6, .part_height = 8}, 2);
    EXPECT_FALSE(end.holds(0, 3)) << "of another size";
}

TEST(WindowEnd, LargeFramesAreNotKept) {
    WindowEnd end;
    end.make_room({.part_width = 2048, .part_height = 1024}, 1);
    EXPECT_TRUE(end.is_kept());
    end.make_room({.part_width = 2048, .part_height = 1025}, 1);
    EXPECT_FALSE(end.is_kept());
}

/// Codes of which each window is new in some places.
class WindowEnds : public testing::Test {
protected:
    WindowEnds() {
        ModelConfig config = test::small_config();
        config.live_edge = LiveEdge::fade;
        model_ = test::random_model(config, 1);
        codes_.emplace_back(kHeight, kWidth, config.latent);
    }
    void next_window() {
        codes_.push_back(codes_.back());
        const int x0 = int(random_() % kWidth), y0 = int(random_() % kHeight);
        for (int y = y0; y < std::min(y0 + 24, kHeight); ++y)
            for (int x = x0; x < std::min(x0 + 24, kWidth); ++x)
                for (float& v : codes_.back().pixel(y, x)) v = float(random_() % 2001) / 1000 - 1;
    }
    LatentMap latent(std::size_t k) const {
        LatentMap map;
        map.values = codes_[k];
        map.window = {SensorTime{} + std::int64_t(k - 1) * kWindow,
                      SensorTime{} + std::int64_t(k) * kWindow};
        return map;
    }
    Frame render(Renderer& renderer, RenderRequest request, int thousandths) const {
        request.t = latent(codes_.size() - 1).window.begin + kWindow * thousandths / 1000;
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        return frame;
    }
    /// By a renderer that has rendered nothing else.
    Frame alone(const RenderRequest& request, int thousandths) const {
        Renderer renderer{model_, kWidth, kHeight, options_};
        for (std::size_t k = 1; k < codes_.size(); ++k) renderer.push(latent(k));
        return render(renderer, request, thousandths);
    }

    Model model_;
    EngineOptions options_{.precision = Precision::f32};
    std::vector<Array3<float>> codes_;
    std::mt19937 random_{1};
};

TEST_F(WindowEnds, AFrameIsTheSameWhateverWasRenderedBefore) {
    const RenderRequest native, half{.width = 48, .height = 32}, larger{.width = 130, .height = 91},
        part{.width = 130, .height = 91, .region = {33, 20, 50, 41}},
        mixture{.sigma_rule = SigmaRule::mixture}, bare{.want_sigma = false};
    const std::vector<RenderRequest> requests{native, native,  native, half,  larger,
                                              part,   mixture, bare,   native};
    for (const bool skips : {true, false}) {
        options_.skip_quiet = skips;
        codes_.resize(1);
        Renderer renderer{model_, kWidth, kHeight, options_};
        for (int k = 1; k <= 12; ++k) {
            next_window();
            renderer.push(latent(std::size_t(k)));
            for (int n = 0; n < 6; ++n) {
                const RenderRequest& request = requests[random_() % requests.size()];
                const int thousandths = std::vector{0, 250, 400, 990, 1000}[random_() % 5];
                const Frame found = render(renderer, request, thousandths),
                            expected = alone(request, thousandths);
                ASSERT_TRUE(same(found.intensity, expected.intensity))
                    << k << " at " << thousandths;
                ASSERT_TRUE(same(found.sigma, expected.sigma)) << k << " at " << thousandths;
            }
        }
    }
}

TEST_F(WindowEnds, AfterAResetNothingIsLeft) {
    Renderer renderer{model_, kWidth, kHeight, options_};
    for (int stream = 1; stream <= 3; ++stream) {
        codes_.resize(1);
        for (std::size_t k = 1; k <= 2; ++k) {
            next_window();
            renderer.push(latent(k));
            EXPECT_TRUE(same(render(renderer, {}, 500).intensity, alone({}, 500).intensity))
                << stream;
        }
        renderer.reset();
    }
}

}  // namespace
}  // namespace eventide
