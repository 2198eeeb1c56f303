// Between which latents an output pixel lies, and how near to each.
#include "src/model/render/sampling.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

TEST(Sampling, TheFirstAndLastOutputPixelsLieOnTheFirstAndLastSensorPixels) {
    for (const int out : {2, 7, 240, 601}) {
        EXPECT_EQ(sample_axis(0, out, 240, 1, Blend::smooth).index, 0);
        EXPECT_EQ(sample_axis(0, out, 240, 1, Blend::smooth).weight[1], 0);
        EXPECT_EQ(sample_axis(out - 1, out, 240, 1, Blend::smooth).index, 239);
        EXPECT_EQ(sample_axis(out - 1, out, 240, 1, Blend::smooth).weight[1], 0);
    }
    for (int i = 0; i < 240; ++i) {
        EXPECT_EQ(sample_axis(i, 240, 240, 1, Blend::smooth).index, i);
        EXPECT_EQ(sample_axis(i, 240, 240, 1, Blend::smooth).weight[0], 1);
    }
    // Stride 2 and an even width: the last pixel lies half a sample past the last sample.
    const AxisSamples last = sample_axis(239, 240, 240, 2, Blend::smooth);
    EXPECT_EQ(last.index, 119);
    EXPECT_EQ(last.weight[0], 1);
    EXPECT_EQ(last.offset[0], 0.5);
}

TEST(Sampling, WeightsInSpaceAreThoseOfTheModelsBlend) {
    for (int i = 0; i < 9; ++i) {  // 8 steps between two samples
        const double f = i / 8.0;
        const AxisSamples linear = sample_axis(i, 9, 2, 1, Blend::linear);
        const AxisSamples smooth = sample_axis(i, 9, 2, 1, Blend::smooth);
        EXPECT_EQ(linear.offset, smooth.offset);
        if (i == 8) continue;  // on the last sample
        EXPECT_DOUBLE_EQ(linear.weight[1], f);
        EXPECT_DOUBLE_EQ(smooth.weight[1], f * f * (3 - 2 * f));
        EXPECT_DOUBLE_EQ(smooth.weight[0] + smooth.weight[1], 1);
    }
}

}  // namespace
}  // namespace eventide
