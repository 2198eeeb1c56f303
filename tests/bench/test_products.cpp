// Useful products of the shipped models, counted by hand for a sensor of 240x180: channels in, out,
// and 9 for a 3x3 convolution, times pixels.
#include "apps/bench/products.h"
#include "src/model/model_file.h"

#include <gtest/gtest.h>

#include <string>

namespace eventide::bench {
namespace {

constexpr double kFull = 180 * 240, kHalf = 90 * 120, kQuarter = 45 * 60, kEighth = 23 * 30,
                 kSixteenth = 12 * 15;

ModelConfig shipped(const std::string& name) {
    return load_model(EVENTIDE_SOURCE_DIR "/config/models/" + name + ".safetensors").config;
}

RenderProducts native(const std::string& name, int lookahead) {
    return render_products(shipped(name), {240, 180, 240, 180, 0, 0, 240, 180}, lookahead);
}

TEST(Products, OfTheDefault) {
    const double expected = kFull * 9 * 21 * 8                                  // in
                            + kFull * 9 * (16 * 16 + 16 * 8)                    // gru.0
                            + kHalf * 9 * 8 * 16 + kQuarter * 9 * 16 * 32       // down
                            + kEighth * 9 * 32 * 64 + kSixteenth * 9 * 64 * 64  //
                            + kSixteenth * 4 * 9 * 64 * 64                      // two blocks
                            + kEighth * 9 * 128 * 64 + kQuarter * 9 * 96 * 32   // up
                            + kHalf * 9 * 48 * 16 + kFull * 9 * 24 * 8          //
                            + kFull * 9 * 8 * 16;                               // out
    EXPECT_EQ(encode_products(shipped("default"), 180, 240), expected);
    // Two codes of 16 in, 32 out; 32 x 32 and 2 x 32 behind, and as many for the end of the window
    // before, with which frames begin.
    EXPECT_EQ(native("default", 0).first, kFull * 2 * 16 * 32);
    EXPECT_EQ(native("default", 0).end, kFull * (32 * 32 + 2 * 32));
    EXPECT_EQ(native("default", 0).frame, kFull * (32 * 32 + 2 * 32));
    EXPECT_EQ(native("default", 2).first, kFull * 3 * 16 * 32);
}

TEST(Products, OfTheSmallOne) {
    const double expected = kFull * 9 * 5 * 8                            // in
                            + kFull * 9 * 16 * 16                        // gru.0, both halves
                            + kHalf * 9 * 8 * 8 + kQuarter * 9 * 8 * 16  // down
                            + kEighth * 9 * 16 * 16 + kSixteenth * 9 * 16 * 32  //
                            + kSixteenth * 4 * 9 * 32 * 32                      // two blocks
                            + kEighth * 9 * 48 * 16 + kQuarter * 9 * 32 * 16    // up
                            + kHalf * 9 * 24 * 8 + kFull * 9 * 16 * 8;
    EXPECT_EQ(encode_products(shipped("small"), 180, 240), expected);
    EXPECT_EQ(native("small", 0).first, kFull * 2 * 8 * 16);
    EXPECT_EQ(native("small", 0).frame, kFull * (16 * 16 + 2 * 16));
    EXPECT_EQ(native("small", 0).end, kFull * (16 * 16 + 2 * 16)) << "the live edge fades";
    EXPECT_EQ(native("small", 1).first, kFull * 5 * 8 * 16) << "this sample's and the next's";
    EXPECT_EQ(native("small", 1).frame, kFull * 2 * (16 * 16 + 2 * 16));
    EXPECT_EQ(native("small", 1).end, 0);
    EXPECT_LT(
        expected + native("small", 0).first + native("small", 0).end + native("small", 0).frame,
        6000 * kFull);
}

TEST(Products, OfTheThesis) {
    const double expected = kFull * 9 * 9 * 24 + kFull * 9 * 48 * 72 + kFull * 9 * 2 * 24 * 24 +
                            kHalf * 9 * 24 * 24 + kHalf * 9 * 48 * 72 + kFull * 9 * 72 * 24 +
                            kFull * 9 * 24 * 24 + kFull * 9 * 24 * 16;
    EXPECT_EQ(encode_products(shipped("thesis"), 180, 240), expected);
    EXPECT_EQ(native("thesis", 0).first, kFull * 9 * 2 * 16 * 128);
    EXPECT_EQ(native("thesis", 0).frame, kFull * (3 * 128 * 128 + 2 * 128));
}

TEST(Products, BetweenSamplesFourAreEvaluated) {
    ModelConfig config;
    config.mlp = {4, 8};
    // 3 px become 5: samples 0, 2, 4 are on pixels, 1 and 3 between two.
    EXPECT_EQ(render_products(config, {3, 3, 5, 5, 0, 0, 5, 5}, 0).frame, 7 * 7 * (4 * 8 + 2 * 8));
}

}  // namespace
}  // namespace eventide::bench
