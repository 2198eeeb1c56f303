// All memory is taken before the first step: steps and frames allocate nothing.
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"
#include "tests/model/engine_choices.h"
#include "tests/model/streams.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/random_model.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

std::int64_t allocations_of(const ModelConfig& config, const EngineOptions& options, int width = 80,
                            Region part = {}) {
    const Model model = test::random_model(config, 1);
    Encoder encoder{model, width, 60, options};
    Renderer renderer{model, width, 60, options};
    test::GridStream stream{config, 60, width, 2};
    LatentMap latent = encoder.make_output();
    RenderRequest request;
    request.width = 100;
    request.height = 75;
    request.region = part;
    Frame frame = renderer.make_output(request);
    std::int64_t counted = 0;
    for (int k = 0; k < 30; ++k) {
        const VoxelGrid& grid = stream.next();
        request.lookahead = std::min(k, 2) * (k % 2);
        request.t = grid.window.end - SensorDuration{50'000 * request.lookahead + 10'000};
        test::AllocationCount count;
        encoder.encode(grid, latent);
        renderer.push(latent);
        renderer.render(request, frame);
        counted += count.stop();
    }
    return counted;
}

TEST(Allocations, NoneAfterConstruction) {
    if (!test::can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    for (const ModelConfig& config : {test::small_config(), test::thesis_config()})
        for (const test::EngineChoice& choice : test::engine_choices()) {
            // oneDNN's own: OnednnConv.AllocatesNoMoreThanItsArgumentLists.
            if (choice.options.kernels != Kernels::own) continue;
            // Slow, and with the same memory as bf16 by the processor.
            if (choice.name == "emulated bf16" && config.encoder == EncoderKind::thesis) continue;
            EXPECT_EQ(allocations_of(config, choice.options), 0) << choice.name;
        }
}

TEST(Allocations, NoneForAPartThatMostTilesLieBeside) {
    if (!test::can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    const Region top{0, 0, 100, 3};
    EXPECT_EQ(allocations_of(test::small_config(), {}, 20, top), 0);
}

TEST(Allocations, TheCounterFires) {
    if (!test::can_count_allocations()) GTEST_SKIP() << "sanitizers bring their own malloc";
    test::AllocationCount count;
    LatentMap latent = Encoder{test::random_model(test::small_config(), 1), 8, 8}.make_output();
    EXPECT_GT(count.stop(), 0);
}

}  // namespace
}  // namespace eventide
