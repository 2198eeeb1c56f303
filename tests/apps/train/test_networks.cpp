// Training and the engine compute the same: torch against plain and fast, with the same weights.
#include "apps/train/data/batch.h"
#include "apps/train/network/networks.h"
#include "apps/train/network/render.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace eventide {
namespace {

constexpr int kHeight = 37, kWidth = 50, kFrames = 7;

/// The last image's event window and what the renderer may know of those around it.
struct Case {
    ModelConfig config;
    int lookahead, width, height;
};

/// [y][x][channel] or [y][x] of what torch has as [1][C][H][W] or [1][H][W].
std::vector<float> flat(const torch::Tensor& x) {
    const torch::Tensor dense = (x.dim() == 4 ? x.permute({0, 2, 3, 1}) : x).contiguous();
    return {dense.data_ptr<float>(), dense.data_ptr<float>() + dense.numel()};
}

std::vector<VoxelGrid> stream(const ModelConfig& config) {
    test::GridStream source{config, kHeight, kWidth, 3};
    std::vector<VoxelGrid> grids;
    for (int k = 0; k < kFrames; ++k)
        grids.push_back(
            source.next(k == 3 ? test::GridStream::Kind::silence : test::GridStream::Kind::patch));
    return grids;
}

std::vector<torch::Tensor> torch_latents(const Model& model, const std::vector<VoxelGrid>& grids) {
    const Parameters parameters = to_parameters(model.weights, torch::kCPU);
    RecurrentState memory = empty_recurrent_state(model.config, 1, kHeight, kWidth, torch::kFloat);
    std::vector<torch::Tensor> latents;
    for (const VoxelGrid& grid : grids) {
        const Array3<float>* values = &grid.values;
        EncodedGrid out =
            encode(model.config, parameters, to_torch({&values, 1}, torch::kCPU), memory.state);
        memory.state = out.state;
        latents.push_back(out.latent);
    }
    return latents;
}

std::vector<LatentMap> engine_latents(const Model& model, const std::vector<VoxelGrid>& grids,
                                      Engine engine) {
    Encoder encoder{model, kWidth, kHeight, {.engine = engine, .precision = Precision::f32}};
    std::vector<LatentMap> latents;
    for (const VoxelGrid& grid : grids) {
        latents.push_back(encoder.make_output());
        encoder.encode(grid, latents.back());
    }
    return latents;
}

/// Points of an image over the whole sensor, in latent pixels (docs/model.md, "Output of size").
PatchGrid points_of(const ModelConfig& config, int width, int height) {
    PatchGrid points;
    for (int j = 0; j < height; ++j)
        points.y.push_back(double(j) * (kHeight - 1) / (height - 1) / config.latent_stride);
    for (int i = 0; i < width; ++i)
        points.x.push_back(double(i) * (kWidth - 1) / (width - 1) / config.latent_stride);
    return points;
}

std::vector<Case> cases() {
    ModelConfig half = test::small_config();
    half.latent_stride = 2;
    ModelConfig mixture = test::small_config();
    mixture.sigma_rule = SigmaRule::mixture;
    // Two hidden layers of one width: the fused renderer's.
    ModelConfig fading = test::small_config();
    fading.unfold = 1;
    fading.live_edge = LiveEdge::fade;
    fading.mlp = {16, 16};
    ModelConfig light = fading;
    light.reset_gate = light.out_layer = false;
    light.latent = light.widths[0];
    return {{test::small_config(), 0, kWidth, kHeight},
            {light, 0, kWidth, kHeight},
            {fading, 0, kWidth, kHeight},
            {fading, 0, 70, 90},
            {fading, 2, 70, 40},
            {test::small_config(), 1, kWidth, kHeight},
            {test::small_config(), 2, 70, 90},
            {half, 2, kWidth, kHeight},
            {mixture, 2, 70, 40},
            {test::thesis_config(), 0, kWidth, kHeight},
            {test::thesis_config(), 2, kWidth, kHeight}};
}

class SameNetwork : public testing::TestWithParam<int> {};

TEST_P(SameNetwork, TorchPlainAndFastGiveTheSameLatentCodes) {
    const torch::NoGradGuard none;
    const Model model = test::random_model(cases()[std::size_t(GetParam())].config, 5);
    const auto grids = stream(model.config);
    const auto judged = torch_latents(model, grids);
    for (const Engine engine : {Engine::plain, Engine::fast}) {
        const auto latents = engine_latents(model, grids, engine);
        for (std::size_t k = 0; k < grids.size(); ++k) {
            const auto expected = flat(judged[k]);
            ASSERT_EQ(latents[k].values.values().size(), expected.size());
            double largest = 1;
            for (const float v : expected) largest = std::max(largest, std::abs(double(v)));
            // float32 sums of some hundred terms in another order, through seven steps of state.
            EXPECT_LT(test::worst(latents[k].values.values(), expected), 2e-4 * largest)
                << "frame " << k << (engine == Engine::plain ? " plain" : " fast");
        }
    }
}

TEST_P(SameNetwork, TorchPlainAndFastGiveTheSameImages) {
    const torch::NoGradGuard none;
    const Case c = cases()[std::size_t(GetParam())];
    const Model model = test::random_model(c.config, 6);
    const auto grids = stream(model.config);
    const auto z = torch_latents(model, grids);
    const auto latents = engine_latents(model, grids, Engine::plain);
    constexpr std::size_t k = 4;   // counted from 0; in silence engines show the window's end
    constexpr double kPart = 0.4;  // of event window k
    const auto code = [&](int ahead) {
        return ahead <= c.lookahead ? z[k + std::size_t(ahead)] : torch::Tensor{};
    };
    RenderTask task{z[k - 1], z[k], code(1), code(2), torch::full({1}, kPart)};
    if (c.config.live_edge == LiveEdge::fade) task.before = z[k - 2];
    const Rendered judged = render(model.config, to_parameters(model.weights, torch::kCPU), {task},
                                   points_of(model.config, c.width, c.height));
    for (const Engine engine : {Engine::plain, Engine::fast}) {
        Renderer renderer{model, kWidth, kHeight, {.engine = engine, .precision = Precision::f32}};
        for (std::size_t i = 0; i <= k + std::size_t(c.lookahead); ++i) renderer.push(latents[i]);
        const Window window = grids[k].window;
        const RenderRequest request{
            .t =
                window.begin + SensorDuration{std::int64_t(kPart * double(window.width().count()))},
            .width = c.width,
            .height = c.height,
            .lookahead = c.lookahead};
        Frame frame = renderer.make_output(request);
        renderer.render(request, frame);
        EXPECT_LT(test::worst(frame.intensity.values(), flat(judged.mu)), 2e-3);
        const auto sigma = flat(judged.log_sigma.exp());
        EXPECT_LT(test::worst(frame.sigma.values(), sigma), 2e-3 * std::exp(1.0));
    }
}

INSTANTIATE_TEST_SUITE_P(Cases, SameNetwork, testing::Range(0, int(cases().size())));

TEST(Networks, WhereNothingHappensTheStateStaysBitForBit) {
    const torch::NoGradGuard none;
    const Model model = test::random_model(test::small_config(), 7);
    const Parameters parameters = to_parameters(model.weights, torch::kCPU);
    const auto busy = torch::rand({1, model.config.input_channels(), kHeight, kWidth});
    const auto empty = empty_state(model.config, 1, kHeight, kWidth, torch::kFloat);
    const EncodedGrid before = encode(model.config, parameters, busy, empty);
    const EncodedGrid after =
        encode(model.config, parameters, torch::zeros_like(busy), before.state);
    EXPECT_TRUE(torch::equal(before.latent, after.latent));
    for (std::size_t l = 0; l < before.state.size(); ++l)
        EXPECT_TRUE(torch::equal(before.state[l], after.state[l])) << "level " << l;
    EXPECT_FALSE(torch::equal(before.state[0], empty[0])) << "events must change the state";
}

TEST(Networks, ANewSceneBeginsEmptyWhateverBecameOfTheStateBefore) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN(),
                    kRunAway = std::numeric_limits<float>::infinity();
    const auto empty = empty_recurrent_state(test::small_config(), 3, 8, 8, torch::kFloat);
    RecurrentState before = empty;
    for (torch::Tensor& map : before.state) {
        map = torch::full_like(map, 2);
        map[0].fill_(kNone);
        map[1].fill_(kRunAway);
    }
    before.latent = torch::full_like(before.latent, kNone);
    before.latent[2].fill_(3);
    const RecurrentState after = begin_segment(before, {true, true, false});
    for (std::size_t l = 0; l < after.state.size(); ++l) {
        EXPECT_TRUE(torch::equal(after.state[l].narrow(0, 0, 2), empty.state[l].narrow(0, 0, 2)));
        EXPECT_TRUE(torch::equal(after.state[l][2], before.state[l][2])) << "goes on";
        EXPECT_TRUE(after.state[l].is_contiguous(torch::MemoryFormat::ChannelsLast));
    }
    EXPECT_TRUE(torch::equal(after.latent.narrow(0, 0, 2), empty.latent.narrow(0, 0, 2)));
    EXPECT_TRUE(torch::equal(after.latent[2], before.latent[2]));
}

TEST(Networks, BrainFloatsStayNearTheFullPrecision) {
    const torch::NoGradGuard none;
    const Model model = test::random_model(test::small_config(), 8);
    const Parameters parameters = to_parameters(model.weights, torch::kCPU);
    const auto grid = torch::rand({1, model.config.input_channels(), kHeight, kWidth});
    const auto state = empty_state(model.config, 1, kHeight, kWidth, torch::kFloat);
    const auto wide = encode(model.config, parameters, grid, state).latent;
    const auto narrow =
        encode(model.config, cast(parameters, torch::kBFloat16), grid, state).latent;
    // 8 bits of mantissa, a dozen layers: some percent of the signal.
    EXPECT_LT((wide - narrow).square().mean().sqrt().item<double>(),
              0.03 * wide.square().mean().sqrt().item<double>());
}

}  // namespace
}  // namespace eventide
