// What a segment of training looks at, and the scenes it looks at.
#include "tests/apps/train/tiny_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

bool whole(double v) {
    return v == std::round(v);
}

/// Every plan stays inside the crop; returns how many of 400 have pixels for points.
int plans_on_pixels(int crop, int patch) {
    DataSettings settings;
    settings.crop = crop;
    settings.patch = patch;
    int on_pixels = 0;
    for (int segment = 0; segment < 400; ++segment) {
        const SegmentPlan plan = segment_plan(settings, segment);
        for (const double begin : {plan.y0, plan.x0}) {
            EXPECT_GE(begin, 0);
            EXPECT_LE(begin + plan.span, crop - 1 + 1e-9);
        }
        on_pixels += plan.span == patch - 1 && whole(plan.y0) && whole(plan.x0);
    }
    return on_pixels;
}

TEST(SegmentPlan, PatchesLieInTheCropAndMostOnItsPixels) {
    const double share = DataSettings{}.whole_probability;
    for (const int patch : {64, 48, 17})
        EXPECT_NEAR(plans_on_pixels(64, patch) / 400.0, share, .1) << patch;
    EXPECT_EQ(plans_on_pixels(64, 90), 0) << "a patch of more points than the crop has pixels";
}

TEST(SegmentPlan, IsTheSameForTheSameSegment) {
    const DataSettings settings;
    for (int segment = 0; segment < 20; ++segment) {
        const SegmentPlan a = segment_plan(settings, segment), b = segment_plan(settings, segment);
        EXPECT_EQ(a.span, b.span);
        EXPECT_EQ(a.y0, b.y0);
        EXPECT_EQ(a.x0, b.x0);
        EXPECT_EQ(a.lookahead, b.lookahead);
    }
}

TEST(SceneStream, IsTheSameHoweverOftenTheRunStops) {
    DataSettings settings = tiny_options({}).data;
    settings.thesis_share = .5;
    const StreamPlace place{.stream = 3, .group = 1, .groups = 2};
    SceneStream whole{settings, few_textures(), place, 0};
    std::vector<StreamSegment> segments;
    for (int i = 0; i < 12; ++i) segments.push_back(whole.next());
    int fresh = 0;
    for (const int at : {0, 1, 5, 9}) {
        // The stream's segment i is the run's segment 2 i + 1.
        StreamSegment again = SceneStream{settings, few_textures(), place, 2 * at}.next();
        const StreamSegment& expected = segments[std::size_t(at)];
        EXPECT_EQ(again.fresh, expected.fresh);
        EXPECT_EQ(again.f, expected.f);
        EXPECT_EQ(again.grids, expected.grids);
        EXPECT_EQ(again.truth, expected.truth);
    }
    for (const StreamSegment& segment : segments) fresh += segment.fresh;
    EXPECT_GT(fresh, 1) << "scenes end";
    EXPECT_LT(fresh, 12) << "scenes last longer than a segment";
}

/// Events per pixel of each event window of a few streams.
std::vector<double> contents(const DataSettings& settings) {
    std::vector<double> all;
    const auto add = [&](const Array3<float>& grid) {
        double events = 0;
        for (int y = 0; y < grid.height(); ++y)
            for (int x = 0; x < grid.width(); ++x)
                for (int b = 0; b < settings.bins; ++b) events += grid(y, x, 4 * b + 3);
        all.push_back(events / (grid.height() * grid.width()));
    };
    for (int n = 0; n < 6; ++n) {
        SceneStream stream{settings, few_textures(), {.stream = n}, 0};
        for (int segment = 0; segment < 6; ++segment)
            for (const Array3<float>& grid : stream.next().grids) add(grid);
    }
    return all;
}

TEST(SceneStream, WindowsThatEndByContentHoldAboutSoManyEventsOrEndByTime) {
    DataSettings settings = tiny_options({}).data;
    settings.episode = {200, 200};
    settings.window_s = {.1, .1};
    settings.window_jitter = 0;
    settings.scene.wander.speed = {200, 400};
    settings.scene.still_background = settings.scene.faint_probability = 0;
    settings.scene.pause_start = 0;
    settings.sensor.threshold = {.1, .1};
    settings.content_epp = {.2, .2};
    const auto share_above = [&](double content_share) {
        settings.content_share = content_share;
        const std::vector<double> all = contents(settings);
        return double(std::ranges::count_if(all, [](double n) { return n > .5; })) /
               double(all.size());
    };
    EXPECT_GT(share_above(0), .5) << "by time alone most windows hold far more";
    EXPECT_LT(share_above(1), .1) << "the rate of the window before is not far off";
}

TEST(SceneStream, ThesisScenesShowTheImageWhateverTheLight) {
    DataSettings settings = tiny_options({}).data;
    settings.scene.target_white = {.5, .5};
    settings.scene.target_white_below_one = 1;  // of all other scenes
    const auto brightest = [&] {
        SceneStream stream{settings, few_textures(), {}, 0};
        float most = 0;
        for (int i = 0; i < 8; ++i)
            for (const auto& truth : stream.next().truth)
                most = std::max(most, *std::ranges::max_element(truth.values()));
        return most;
    };
    EXPECT_LE(brightest(), .5f);
    settings.thesis_share = 1;
    EXPECT_GT(brightest(), .6f);
}

}  // namespace
}  // namespace eventide
