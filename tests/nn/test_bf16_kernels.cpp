// The kernels of bf16 numbers against the plain ones.
#include "src/kernels/bf16_kernels.h"
#include "src/kernels/vector_kernels.h"
#include "tests/nn/fills.h"
#include "tests/nn/instruction_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

namespace eventide {
namespace {

using test::Fill;

TEST(Bf16, RoundingIsToTheNearestEven) {
    const auto back = [](std::uint16_t v) { return std::bit_cast<float>(std::uint32_t(v) << 16); };
    EXPECT_EQ(back(to_bf16(1.0F)), 1.0F);
    EXPECT_EQ(back(to_bf16(1.0F + 0x1p-8F)), 1.0F) << "a tie goes to the even one";
    EXPECT_EQ(back(to_bf16(1.0F + 0x1.8p-7F)), 1.0F + 0x1p-6F);
    EXPECT_EQ(back(to_bf16(-3.14159F)), -3.140625F);
}

void expect_made_bf16(const Bf16Kernels& kernels) {
    test::Numbers numbers{2};
    for (const int channels : {1, 2, 5, 16, 21, 33, 64}) {
        const auto n = std::size_t(channels), pairs = (n + 1) / 2;
        const auto in = numbers.many(3 * n, Fill::mixed);
        constexpr std::uint32_t kMark = 0x4d4d'4d4d;
        std::vector<std::uint32_t> out(3 * pairs + 1, kMark);
        kernels.pixels_to_bf16(in.data(), 3, channels, out.data());
        EXPECT_EQ(out.back(), kMark);
        for (std::size_t p = 0; p < 3; ++p) {
            for (std::size_t c = 0; c < n; ++c) {
                const std::uint32_t pair = out[p * pairs + c / 2];
                EXPECT_EQ(std::uint16_t(c % 2 == 0 ? pair : pair >> 16), to_bf16(in[p * n + c]));
            }
            if (n % 2 != 0) {
                EXPECT_EQ(out[(p + 1) * pairs - 1] >> 16, 0U) << "beside the last";
            }
        }
        std::vector<std::uint16_t> row(3 * n + 1, 77);
        kernels.row_to_bf16(in.data(), 3 * n, row.data());
        EXPECT_EQ(row.back(), 77);
        for (std::size_t i = 0; i < 3 * n; ++i) EXPECT_EQ(row[i], to_bf16(in[i]));
    }
}
TEST(Bf16, RowsAreNarrowedNumberByNumber) {
    expect_made_bf16(plain::bf16_kernels());
    if (bf16_kernels() == nullptr) GTEST_SKIP() << "this processor has no bf16 products";
    for (const Bf16Kernels* kernels : test::all_bf16_kernels()) expect_made_bf16(*kernels);
}

/// An area of two stretches of `length` pairs, as a convolution's rows lie: pixels overlap.
struct Bf16Work {
    static constexpr int kHeight = 3, kPairs = 200;
    int width, length, outputs;
    std::vector<std::uint32_t> in, weight;
    std::vector<float> bias;
    std::array<Stretch, 2> stretches;

    Bf16Work(int w, int l, int o) : width(w), length(l), outputs(o) {
        test::Numbers numbers{5};
        const std::size_t packed = packed_size(2, length, outputs, bf16_lanes(outputs));
        in.resize(std::size_t(kHeight + 1) * kPairs);
        weight.resize(packed);
        for (auto* words : {&in, &weight})
            for (std::uint32_t& word : *words)
                word = to_bf16(numbers.next(Fill::ordinary)) |
                       std::uint32_t{to_bf16(numbers.next(Fill::ordinary))} << 16;
        bias.assign(packed / std::size_t(2 * length), 0.25F);
        clear_past_the_last();
        for (std::size_t s = 0; s < 2; ++s)
            stretches[s] = {in.data() + s * kPairs, 3, kPairs, length};
    }
    /// As PackedWeights fills up vectors: zeros.
    void clear_past_the_last() {
        const int lanes = bf16_lanes(outputs);
        std::fill(bias.begin() + outputs, bias.end(), 0.0F);
        std::size_t at = 0;
        for (int first = 0; first < outputs;) {
            const int block = outputs - first > lanes ? 2 * lanes : lanes;
            for (int unit = 0; unit < 2 * length; ++unit)
                for (int o = first; o < first + block; ++o, ++at)
                    if (o >= outputs) weight[at] = 0;
            first += block;
        }
    }
    /// The outputs, as float32 or as bf16, of each row one behind the other; how many were written
    /// outside of them is to be none.
    std::vector<float> run(const Bf16Kernels& kernels, bool to_bf16, bool relu) {
        const int units = to_bf16 ? (outputs + 1) / 2 : outputs;
        test::Guarded out{std::size_t(kHeight * width * units)};
        DotArea area;
        area.stretches = stretches.data();
        area.count = 2;
        area.height = kHeight;
        area.width = width;
        area.outputs = outputs;
        area.weight = weight.data();
        area.bias = bias.data();
        area.relu = relu;
        area.to_bf16 = to_bf16;
        area.out = out.data();
        area.out_step = units;
        area.out_pitch = width * units;
        kernels.dot_area(area);
        EXPECT_TRUE(out.intact()) << outputs;
        const auto pixels = std::size_t(kHeight * width);
        std::vector<float> wide(pixels * std::size_t(outputs));
        const auto* numbers = reinterpret_cast<const std::uint16_t*>(out.data());
        for (std::size_t p = 0; to_bf16 && outputs % 2 != 0 && p < pixels; ++p)
            EXPECT_EQ(numbers[(p + 1) * 2 * std::size_t(units) - 1], 0)
                << "beside the last of an odd number";
        for (std::size_t p = 0; p < pixels; ++p)
            for (std::size_t o = 0; o < std::size_t(outputs); ++o)
                wide[p * std::size_t(outputs) + o] =
                    to_bf16 ? from_bf16(numbers[p * 2 * std::size_t(units) + o])
                            : out.data()[p * std::size_t(units) + o];
        return wide;
    }
};

/// Widths that are no multiple of a tile's, products of 5 (too few for a tile) to 40 pairs.
void expect_products(const Bf16Kernels& kernels) {
    for (const int outputs : {1, 8, 9, 16, 17, 32, 40, 64})
        for (const int width : {1, 15, 16, 17, 35})
            for (const int length : {5, 12, 16, 33, 40}) {
                Bf16Work work{width, length, outputs};
                for (const bool to_bf16 : {false, true})
                    for (const bool relu : {false, true}) {
                        const auto fast = work.run(kernels, to_bf16, relu);
                        const auto plain = work.run(plain::bf16_kernels(), to_bf16, relu);
                        // The processor may sum a pair's two products before it adds them: one
                        // rounding elsewhere; and one that ends in another bf16 number.
                        const double share = to_bf16 ? 1.0 / 128 : 1e-6;
                        for (std::size_t i = 0; i < fast.size(); ++i)
                            ASSERT_NEAR(fast[i], plain[i], 1e-5 + share * std::abs(plain[i]))
                                << outputs << " outputs, width " << width << ", pairs " << length;
                    }
            }
}
TEST(Bf16, TheProcessorsProductsAreThePlainOnes) {
    if (bf16_kernels() == nullptr) GTEST_SKIP() << "this processor has no bf16 products";
    expect_products(avx512_bf16::bf16_kernels());
}
TEST(Bf16, ProductsOfTilesAreThePlainOnes) {
    if (amx_kernels() == nullptr) GTEST_SKIP() << "this processor has no AMX";
    expect_products(*amx_kernels());
}

}  // namespace
}  // namespace eventide
