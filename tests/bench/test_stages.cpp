// What a measurement of stages says, and that it says all of it; not how long they took.
#include "apps/bench/stage_table.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace eventide::bench {
namespace {

TEST(Stages, SpreadIsMedianAndQuartiles) {
    const Spread spread = spread_of({5, 1, 2, 4, 3});
    EXPECT_EQ(spread.median, 3);
    EXPECT_EQ(spread.low, 2);
    EXPECT_EQ(spread.high, 4);
    EXPECT_EQ(spread_of({1, 2}).median, 1.5);
    EXPECT_EQ(spread_of({}).median, 0);
}

TEST(Stages, ShareIsUsefulProductsOverThePeak) {
    Stage stage;
    stage.products = 5e6;
    stage.time.cpu_ms.median = 2;
    EXPECT_DOUBLE_EQ(stage.gflops(), 5);
    EXPECT_DOUBLE_EQ(stage.share(50), .1);
    EXPECT_EQ(stage.share(0), 0) << "a peak that is not known";
}

TEST(Stages, JsonHasAllKeys) {
    const auto json = stages_json({StageRow{}}, Peaks{})[0];
    for (const char* key : {"encode_ms", "render_fresh_ms", "render_again_ms", "bin_mev_s",
                            "peak_f32_gflops", "peak_bf16_gflops", "share"})
        EXPECT_TRUE(json.contains(key)) << key;
    for (const char* stage : {"encode", "render_fresh", "render_again"})
        EXPECT_TRUE(json["share"].contains(stage)) << stage;
}

}  // namespace
}  // namespace eventide::bench
