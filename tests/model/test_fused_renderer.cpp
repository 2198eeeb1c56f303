// A renderer whose frames the camera's images correct: which images count, and what is rendered.
#include "tests/model/fused_chain.h"

#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

namespace eventide {
namespace {

using namespace test;
using Kind = GridStream::Kind;
using Chain = FusedChain;

/// The whole chain, for each lookahead: an image in silence is what frames show from then on.
TEST(FusedRenderer, ShowsTheImageOfAStillScene) {
    for (const int lookahead : {0, 1, 2}) {
        Chain chain{lookahead};
        SensorTime t{};
        for (int i = 0; i < 12; ++i) {
            const Window window = chain.encode_next(i < 5 ? Kind::patch : Kind::silence);
            if (i == 8) chain.fused.give(image_of(ramp(), window.end));
            if (i == 9) t = window.end;
            chain.push(i < 5 ? 1.F : 0.F);
        }
        const Frame frame = chain.shown(t);
        EXPECT_EQ(chain.fused.used(), 1U);
        EXPECT_EQ(chain.fused.dropped(), 0U);
        for (std::size_t i = 0; i < frame.intensity.values().size(); ++i)
            ASSERT_NEAR(frame.intensity.values()[i], ramp().values()[i], 1e-3) << lookahead;
    }
}

TEST(FusedRenderer, AnImageFromBeforeTheFirstWindowIsTheFirstFrame) {
    for (const int lookahead : {0, 1, 2}) {
        Chain chain{lookahead};
        chain.encode_next(Kind::silence);
        chain.push(0);
        chain.begin_anew();  // windows of another clock came before
        SensorTime first{};
        for (int i = 0; i < 3; ++i) {
            const Window window = chain.encode_next(Kind::silence);
            if (i == 0) {
                first = window.begin + SensorDuration{1};
                chain.fused.give(image_of(ramp(), window.begin - SensorDuration{4'000}));
            }
            chain.push(0);
        }
        const Frame frame = chain.shown(first);
        for (std::size_t i = 0; i < frame.intensity.values().size(); ++i)
            ASSERT_NEAR(frame.intensity.values()[i], ramp().values()[i], 5e-3) << lookahead;
    }
}

/// The model still remembers its window, or does not any more.
TEST(FusedRenderer, AFirstImageThatIsLateDoesNotMakeFramesJump) {
    for (const int windows_late : {1, 4}) {
        Chain chain{0};
        std::vector<Window> windows;
        for (int i = 0; i < 8; ++i) {
            windows.push_back(chain.encode_next(i < 3 ? Kind::patch : Kind::silence));
            if (i == 7)
                chain.fused.give(image_of(ramp(), windows[std::size_t(7 - windows_late)].end));
            chain.push(i < 3 ? 1.F : 0.F);
        }
        EXPECT_EQ(chain.fused.used(), 1U);
        const RenderRequest at_begin{.t = windows[7].begin + SensorDuration{1}};
        Frame alone = chain.renderer.make_output(at_begin);
        chain.renderer.render(at_begin, alone);
        const Frame found = chain.shown(at_begin);
        for (std::size_t i = 0; i < found.intensity.values().size(); ++i)
            ASSERT_NEAR(found.intensity.values()[i], alone.intensity.values()[i], 1e-3)
                << windows_late << " windows late";
    }
}

/// What the flow was found with at a window's end is what a frame shows there.
void expect_none_rendered_twice(const RenderRequest& request) {
    Chain chain{0};
    Renderer& renderer = chain.renderer;
    FusedRenderer& fused = chain.fused;
    RenderRequest twice = request;
    twice.width = 2 * kWidth;
    twice.height = 2 * kHeight;
    fused.prepare(request);
    Frame frame = renderer.make_output(request), larger = renderer.make_output(twice);
    std::uint64_t at_ends = 0, at_times_within = 0, larger_at_ends = 0;
    for (int i = 0; i < 12; ++i) {
        const Window window = chain.encode_next(Kind::everywhere);
        fused.give(image_of(ramp(), window.begin + SensorDuration{1}));
        chain.push(1);
        const auto cost_of = [&](RenderRequest wanted, SensorTime t, Frame& out) {
            const std::uint64_t before = renderer.pixels_rendered();
            wanted.t = t;
            fused.prepare(wanted);
            fused.render(wanted, out);
            return renderer.pixels_rendered() - before;
        };
        at_ends += cost_of(request, window.end, frame);
        larger_at_ends += cost_of(twice, window.end, larger);
        at_times_within += cost_of(request, window.end - SensorDuration{7}, frame);
    }
    constexpr std::uint64_t kPixels = std::uint64_t{kWidth} * kHeight;
    EXPECT_EQ(at_ends, 0U);
    EXPECT_EQ(at_times_within, 12 * kPixels);
    EXPECT_EQ(larger_at_ends, 12 * 4 * kPixels);
}

TEST(FusedRenderer, AFrameAtAWindowsEndIsNotRenderedTwice) {
    expect_none_rendered_twice({});
    expect_none_rendered_twice({.sigma_rule = SigmaRule::mixture});
    expect_none_rendered_twice({.want_sigma = false});
}

/// Corners of frames lie on corners of the sensor.
TEST(FusedRenderer, ALargerFrameIsCorrectedForItsOwnTime) {
    Chain chain{0};
    RenderRequest request, larger{.width = 2 * kWidth - 1, .height = 2 * kHeight - 1};
    for (int i = 0; i < 6; ++i) {
        const Window window = chain.encode_next(Kind::everywhere);
        if (i == 2) chain.fused.give(image_of(ramp(), window.end));
        chain.push(.05F);
        for (const int us : {10'000, 50'000}) {
            larger.t = request.t = window.begin + SensorDuration{us};
            const Frame frame = chain.shown(request), twice = chain.shown(larger);
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x)
                    ASSERT_NEAR(twice.intensity(2 * y, 2 * x), frame.intensity(y, x), 1e-5);
        }
    }
}

/// Of a still scene and images of one grey each, given before the fifth window of 50 ms.
struct GivenInSilence {
    float shown = 0;
    std::uint64_t used = 0, dropped = 0;
};

GivenInSilence given_in_silence(const std::vector<std::pair<float, double>>& greys_and_ms) {
    Chain chain{0};
    RenderRequest request;
    chain.fused.prepare(request);
    Frame frame = chain.renderer.make_output(request);
    for (int i = 0; i < 8; ++i) {
        request.t = chain.encode_next(i < 3 ? Kind::patch : Kind::silence).end;
        if (i == 4)
            for (const auto& [grey, ms] : greys_and_ms)
                chain.fused.give(image_of(constant(grey), request.t + (at_ms(ms) - at_ms(0))));
        chain.push(i < 3 ? 1.F : 0.F);
    }
    chain.fused.render(request, frame);
    return {frame.intensity(kHeight / 2, kWidth / 2), chain.fused.used(), chain.fused.dropped()};
}

TEST(FusedRenderer, AnImageOfAWrongTimeDoesNotHoldUpTheOthers) {
    constexpr double kAnHour = 3'600'000;
    const GivenInSilence given = given_in_silence({{.9F, kAnHour}, {.3F, -.001}, {.6F, 0}});
    EXPECT_NEAR(given.shown, .6, 1e-3);
    EXPECT_EQ(given.used, 2U);
    EXPECT_EQ(given.dropped, 1U);
}

TEST(FusedRenderer, AnImageThatIsOlderThanTheOneBeforeIsDropped) {
    const GivenInSilence given = given_in_silence({{.6F, 0}, {.3F, -.001}});
    EXPECT_NEAR(given.shown, .6, 1e-3);
    EXPECT_EQ(given.used, 1U);
    EXPECT_EQ(given.dropped, 1U);
}

TEST(FusedRenderer, OfTwoImagesOfOneTimeTheLaterCounts) {
    const GivenInSilence given = given_in_silence({{.3F, 0}, {.6F, 0}});
    EXPECT_NEAR(given.shown, .6, 1e-3);
    EXPECT_EQ(given.used, 2U);
    EXPECT_EQ(given.dropped, 0U);
}

TEST(FusedRenderer, TakesAllThatCameBeforeAWindowAndTellsWhetherAnyDid) {
    Chain chain{0};
    const Window window = chain.encode_next(Kind::patch);
    int left = 0;
    const auto next = [&] {
        return left-- > 0 ? std::optional{image_of(ramp(), window.end)} : std::nullopt;
    };
    EXPECT_FALSE(chain.fused.give_all(next));
    left = 2;
    EXPECT_TRUE(chain.fused.give_all(next));
    chain.push(1);
    EXPECT_EQ(chain.fused.used(), 2U);
}

TEST(FusedRenderer, AfterAResetAnotherClockCounts) {
    for (const int lookahead : {0, 2}) {
        Chain chain{lookahead};
        const auto see = [&](int windows) {
            for (int i = 0; i < windows; ++i) {
                const Window window = chain.encode_next(Kind::silence);
                chain.fused.give(image_of(ramp(), window.end));
                chain.push(0);
            }
        };
        see(6);
        EXPECT_EQ(chain.fused.used(), 6U - unsigned(lookahead));
        const ReferenceImage of_an_hour_later = image_of(ramp(), at_ms(3'600'000));
        chain.fused.give(of_an_hour_later);
        chain.begin_anew();
        EXPECT_EQ(chain.fused.dropped(), 1U + unsigned(lookahead)) << "of the clock before";
        see(4);
        EXPECT_EQ(chain.fused.used(), 10U - 2 * unsigned(lookahead));
        EXPECT_EQ(chain.fused.dropped(), 1U + unsigned(lookahead));
    }
}

TEST(FusedRenderer, AfterAResetFramesAreThoseOfAFreshOne) {
    for (const int lookahead : {0, 1, 2}) {
        const auto frame_of = [lookahead](Chain& chain, float grey) {
            std::vector<SensorTime> ends;
            for (int i = 0; i < 6; ++i) {
                const Window window = chain.encode_next(Kind::patch);
                chain.fused.give(image_of(i % 2 == 0 ? ramp() : constant(grey), window.end));
                chain.push(.3F);
                ends.push_back(window.end);
            }
            return chain.shown(ends[std::size_t(5 - lookahead)]).intensity;
        };
        Chain used{lookahead}, fresh{lookahead};
        frame_of(used, .9F);
        used.begin_anew();
        EXPECT_EQ(frame_of(used, .2F), frame_of(fresh, .2F)) << lookahead;
    }
}

TEST(FusedRenderer, AnImageWithoutPixelsTellsNothing) {
    Chain chain{0};
    ReferenceImage none;
    none.t = chain.encode_next(Kind::patch).end;
    chain.fused.give(none);
    chain.push(1);
    EXPECT_EQ(chain.fused.used() + chain.fused.dropped(), 0U);
}

TEST(FusedRenderer, AFloodOfImagesIsBounded) {
    const Model model = test::random_model(test::small_config(), 1);
    Renderer renderer{model, kWidth, kHeight};
    FusedRenderer fused{renderer, kWidth, kHeight, 0};
    for (int i = 0; i < 1000; ++i) fused.give(image_of(ramp(), at_ms(i)));
    EXPECT_EQ(fused.dropped(), 1000 - FusedRenderer::kMaxWaiting);
}

}  // namespace
}  // namespace eventide
