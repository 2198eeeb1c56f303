// What a segment asks of the network: when, with which lookahead, and what counts.
#include "apps/train/data/batch.h"
#include "tests/apps/train/tiny_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace eventide {
namespace {

TEST(SegmentPlan, LooksAheadAsOftenAsAModelWillBeUsedSo) {
    const DataSettings settings;
    std::array<double, 3> share{};
    double first = 0;
    constexpr int kPlans = 2000;
    for (int segment = 0; segment < kPlans; ++segment) {
        const SegmentPlan plan = segment_plan(settings, segment);
        ASSERT_EQ(int(plan.lookahead.size()), settings.rendered);
        for (const int ahead : plan.lookahead)
            share.at(std::size_t(ahead)) += 1.0 / (kPlans * settings.rendered);
        ASSERT_GE(plan.first_rendered, 0);
        ASSERT_LE(plan.first_rendered, settings.event_windows - settings.rendered);
        first += double(plan.first_rendered) / kPlans;
    }
    EXPECT_NEAR(share[0], .5, .02);
    EXPECT_NEAR(share[1], .2, .02);
    EXPECT_NEAR(share[2], .3, .02);
    EXPECT_NEAR(first, .5 * (settings.event_windows - settings.rendered), .1) << "anywhere";
}

TEST(SegmentPlan, SaysWhichPatchesLieOnPixels) {
    DataSettings settings;
    settings.whole_probability = .3;
    constexpr int kPlans = 2000;
    int on_pixels = 0;
    for (int segment = 0; segment < kPlans; ++segment) {
        const SegmentPlan plan = segment_plan(settings, segment);
        const bool one_to_one = plan.span == settings.patch - 1.0;
        EXPECT_EQ(plan.on_pixels,
                  one_to_one && plan.x0 == std::round(plan.x0) && plan.y0 == std::round(plan.y0));
        on_pixels += plan.on_pixels;
    }
    EXPECT_NEAR(double(on_pixels) / kPlans, .3, .03);
}

TEST(SceneStream, ImagesLieAtTheirWindowsEndsOrAnywhereInThem) {
    DataSettings settings = tiny_options({}).data;
    settings.edge_probability = .4;
    int edges = 0, all = 0;
    double others = 0;
    for (int n = 0; n < 12; ++n) {
        SceneStream stream{settings, few_textures(), {.stream = n}, 0};
        for (int segment = 0; segment < 12; ++segment)
            for (const float f : stream.next().f) {
                ASSERT_GT(f, 0);
                ASSERT_LE(f, 1);
                ++all;
                edges += f == 1;
                others += f == 1 ? 0 : double(f);
            }
    }
    EXPECT_NEAR(double(edges) / all, .4, .08);
    EXPECT_NEAR(others / (all - edges), .5, .06);
}

TEST(SceneStream, ASceneCountsOnceItHasBeenSeenForAWhile) {
    DataSettings settings = tiny_options({}).data;
    settings.warm_windows = 6;
    settings.episode = {16, 16};  // four segments of four event windows
    SceneStream stream{settings, few_textures(), {}, 0};
    for (int segment = 0; segment < 12; ++segment) {
        const StreamSegment seen = stream.next();
        EXPECT_EQ(seen.fresh, segment % 4 == 0);
        const int first = segment_plan(settings, segment).first_rendered;
        for (std::size_t i = 0; i < seen.weight.size(); ++i) {
            const int window = segment % 4 * settings.event_windows + first + int(i) + 1;
            EXPECT_EQ(seen.weight[i], window > settings.warm_windows ? 1 : 0) << window;
        }
    }
}

/// Frames of event windows 0 to 3 of a segment of four, with the last window's grid as it is or
/// without events.
torch::Tensor rendered_with(const std::vector<int>& lookahead, bool last_is_empty) {
    const TrainOptions options = tiny_options({});
    const Parameters parameters = initial_parameters(options.model, 3, torch::kCPU);
    DataSettings data = options.data;
    data.bins = options.model.bins;
    data.seed = 5;
    const StreamSegment segment = SceneStream{data, few_textures(), {}, 0}.next();
    TrainingBatch batch = to_batch({&segment, 1}, torch::kCPU);
    EXPECT_EQ(batch.grids.size(), 4U);
    if (last_is_empty) batch.grids.back() = torch::zeros_like(batch.grids.back());
    batch.f.assign(4, torch::tensor({.5F}));
    const SegmentPlan plan{.span = double(data.crop - 1), .lookahead = lookahead};
    RecurrentState state =
        empty_recurrent_state(options.model, 1, data.crop, data.crop, torch::TensorOptions{});
    return run_segment(options.model, parameters, plan, batch, data.patch, state).mu.detach();
}

TEST(RunSegment, LooksNoFurtherAheadThanThePlanSays) {
    for (const int ahead : {0, 1, 2}) {
        const std::vector<int> lookahead(4, ahead);
        const torch::Tensor full = rendered_with(lookahead, false),
                            empty = rendered_with(lookahead, true);
        for (int k = 0; k < 4; ++k)
            EXPECT_EQ(torch::equal(full[k], empty[k]), k + ahead < 3)
                << "window " << k << ", lookahead " << ahead;
    }
    // Past the segment's end nothing is known, whatever the lookahead.
    const torch::Tensor none = rendered_with({0, 0, 0, 0}, false),
                        two = rendered_with({2, 2, 2, 2}, false);
    EXPECT_TRUE(torch::equal(none[3], two[3]));
    EXPECT_FALSE(torch::equal(none[1], two[1]));
}

TEST(BeginSegment, EmptiesFreshStreamsAndCutsGradients) {
    const torch::Tensor map = torch::full({2, 3, 4, 4}, 2.0).set_requires_grad(true);
    const RecurrentState next = begin_segment({{map * 1, map * 2}, map * 3}, {false, true});
    ASSERT_EQ(next.state.size(), 2U);
    for (const auto& [begun, value] :
         {std::pair{next.state[0], 2.0}, {next.state[1], 4.0}, {next.latent, 6.0}}) {
        EXPECT_FALSE(begun.requires_grad());
        EXPECT_EQ(begun[0].min().item<double>(), value);
        EXPECT_EQ(begun[0].max().item<double>(), value);
        EXPECT_EQ(begun[1].abs().max().item<double>(), 0);
    }
}

}  // namespace
}  // namespace eventide
