// The element-wise kernels against double, at every length and with numbers that saturate.
#include "src/kernels/bf16_kernels.h"
#include "src/kernels/plain/activations.h"
#include "src/kernels/vector_kernels.h"
#include "tests/nn/fills.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace eventide {
namespace {

using test::Fill;

/// A few units in the last place of numbers up to 1: exp within 1 ulp, one division, one sum.
constexpr double kGateTolerance = 4e-7;

double limit(double exact, double tolerance) {
    return tolerance * std::max(1.0, std::abs(exact));
}

class Lengths : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(VectorKernels, Lengths, testing::Values(1, 3, 8, 15, 16, 17, 24, 64, 85));

TEST_P(Lengths, GatesAndActivationsAgreeWithDouble) {
    const VectorKernels& k = vector_kernels();
    const int n = GetParam();
    const auto count = std::size_t(n);
    for (const Fill fill : test::kFills) {
        test::Numbers numbers{7};
        const auto a = numbers.many(count, fill), b = numbers.many(count, fill);
        const auto h = numbers.many(count, Fill::ordinary);
        test::Guarded out{count};
        const auto expect = [&](auto exact, double tolerance, const char* what) {
            EXPECT_TRUE(out.intact()) << what;
            for (std::size_t i = 0; i < count; ++i)
                ASSERT_LE(std::abs(out.data()[i] - exact(i)), limit(exact(i), tolerance))
                    << what << " of " << a[i] << ", " << b[i];
        };
        k.compress(a.data(), out.data(), count);
        expect([&](std::size_t i) { return plain::compress(double(a[i])); }, 3e-7, "compress");
        auto gates = a, candidate = b;
        k.sigmoid(gates.data(), count);
        k.reset_state(gates.data(), n, h.data(), out.data(), n, 1);
        expect([&](std::size_t i) { return plain::sigmoid(double(a[i])) * h[i]; }, kGateTolerance,
               "reset");
        k.update_state(h.data(), gates.data(), n, candidate.data(), out.data(), n, 1);
        expect(
            [&](std::size_t i) {
                return h[i] + plain::sigmoid(double(a[i])) * (std::tanh(double(b[i])) - h[i]);
            },
            2 * kGateTolerance, "update");
        k.add_relu(a.data(), b.data(), out.data(), count);
        expect([&](std::size_t i) { return plain::relu(double(a[i]) + b[i]); }, 1e-7, "add");
        k.elu(a.data(), out.data(), count);
        expect([&](std::size_t i) { return plain::elu(double(a[i])); }, 3e-7, "elu");
    }
}

TEST_P(Lengths, NearIsEveryNumberWithinTheBound) {
    const VectorKernels& k = vector_kernels();
    const auto count = std::size_t(GetParam());
    const std::vector<float> a(count, 1.0F);
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<float> b = a;
        b[i] = 1.25F;
        EXPECT_TRUE(k.are_near(a.data(), b.data(), .25F, count));
        EXPECT_FALSE(k.are_near(a.data(), b.data(), .2F, count)) << i;
        b[i] = NAN;
        EXPECT_FALSE(k.are_near(a.data(), b.data(), .25F, count)) << i;
    }
}

/// Gates of the network lie beside each other, [u; r], and a row of pixels is one call.
TEST(VectorKernels, RowsOfGatesAreTheirPixels) {
    const VectorKernels& k = vector_kernels();
    for (const int channels : {1, 4, 8, 12, 16, 24, 40}) {
        constexpr int kPixels = 5;
        const auto c = std::size_t(channels), count = kPixels * c;
        test::Numbers numbers{11};
        const auto gates = numbers.many(2 * count, Fill::ordinary),
                   candidate = numbers.many(count, Fill::ordinary),
                   h = numbers.many(count, Fill::ordinary);
        test::Guarded next{count}, one{count}, kept{count}, alone{count};
        auto row = candidate, pixels = candidate;
        k.update_state(h.data(), gates.data(), 2 * channels, row.data(), next.data(), channels,
                       kPixels);
        k.reset_state(gates.data() + c, 2 * channels, h.data(), kept.data(), channels, kPixels);
        for (std::size_t p = 0; p < kPixels; ++p) {
            k.update_state(h.data() + p * c, gates.data() + 2 * p * c, channels,
                           pixels.data() + p * c, one.data() + p * c, channels, 1);
            k.reset_state(gates.data() + (2 * p + 1) * c, channels, h.data() + p * c,
                          alone.data() + p * c, channels, 1);
        }
        EXPECT_TRUE(next.intact() && kept.intact());
        EXPECT_TRUE(std::equal(next.data(), next.data() + count, one.data())) << channels;
        EXPECT_TRUE(std::equal(kept.data(), kept.data() + count, alone.data())) << channels;
    }
}

TEST(VectorKernels, SaturatedGatesAreExact) {
    const float h = 0.25F, r = 0.5F;
    float out = 0;
    for (const float big : {60.0F, 1e30F, std::numeric_limits<float>::max()}) {
        float open = big, closed = -big, full = big, candidate = r;
        vector_kernels().sigmoid(&open, 1);
        vector_kernels().sigmoid(&closed, 1);
        vector_kernels().update_state(&h, &open, 1, &full, &out, 1, 1);
        EXPECT_EQ(out, 1.0F);
        vector_kernels().update_state(&h, &closed, 1, &candidate, &out, 1, 1);
        EXPECT_NEAR(out, h, 1e-7) << "a closed gate keeps the state";
    }
}

TEST(VectorKernels, TwoOutputsAreTwoSumsOfProducts) {
    test::Numbers numbers{3};
    for (const int width : {1, 7, 16, 30, 64, 128})
        for (const int pixels : {1, 5, 16, 21, 56}) {
            const auto n = std::size_t(width), count = std::size_t(pixels);
            const auto in = numbers.many(count * n, Fill::ordinary),
                       weight = numbers.many(2 * n, Fill::ordinary);
            const float bias[] = {0.5F, -2};
            test::Guarded first{count}, second{count};
            vector_kernels().two_outputs(
                {in.data(), weight.data(), bias, pixels, width, first.data(), second.data()});
            EXPECT_TRUE(first.intact() && second.intact());
            for (std::size_t p = 0; p < count; ++p)
                for (std::size_t o = 0; o < 2; ++o) {
                    double sum = bias[o];
                    for (std::size_t i = 0; i < n; ++i)
                        sum += double(in[p * n + i]) * weight[o * n + i];
                    EXPECT_NEAR((o == 0 ? first : second).data()[p], sum, 1e-5);
                }
        }
}

TEST(VectorKernels, OffsetsAreAddedToTheSumsOfTheirColumn) {
    constexpr int kPixels = 7;
    const int column[kPixels] = {0, 0, 1, 1, 2, 4, 4};
    for (const int width : {1, 8, 17, 32, 40}) {
        test::Numbers numbers{6};
        const auto n = std::size_t(width), step = (n + 1) / 2 * 2;
        const auto sums = numbers.many(5 * n, Fill::ordinary),
                   dx = numbers.many(kPixels, Fill::ordinary),
                   base = numbers.many(n, Fill::ordinary), slope = numbers.many(n, Fill::ordinary);
        std::vector<float> exact;
        for (std::size_t p = 0; p < kPixels; ++p)
            for (std::size_t c = 0; c < n; ++c)
                exact.push_back(std::max(
                    0.0F, sums[std::size_t(column[p]) * n + c] + base[c] + dx[p] * slope[c]));
        test::Guarded out{kPixels * n};
        vector_kernels().offset_rows({sums.data(), 0, column, dx.data(), base.data(), slope.data(),
                                      kPixels, width, out.data()});
        EXPECT_TRUE(out.intact());
        for (std::size_t i = 0; i < exact.size(); ++i)
            ASSERT_NEAR(out.data()[i], exact[i], 1e-6) << width;
        const auto expect_rows = [&](const Bf16Kernels& kernels) {
            std::vector<std::uint32_t> narrow(5 * step / 2);
            kernels.pixels_to_bf16(sums.data(), 5, width, narrow.data());
            test::Guarded rows{kPixels * step / 2};
            kernels.offset_rows({narrow.data(), 0, column, dx.data(), base.data(), slope.data(),
                                 kPixels, width, rows.data()});
            EXPECT_TRUE(rows.intact());
            const auto* row = reinterpret_cast<const std::uint16_t*>(rows.data());
            for (std::size_t p = 0; p < kPixels; ++p)
                for (std::size_t c = 0; c < step; ++c)
                    ASSERT_NEAR(from_bf16(row[p * step + c]), c < n ? exact[p * n + c] : 0,
                                1.0 / 64)
                        << width;
        };
        expect_rows(plain::bf16_kernels());
        if (bf16_kernels() != nullptr) expect_rows(*bf16_kernels());
    }
}

TEST(VectorKernels, ASampleIsWeighedByItsShare) {
    for (const int pixels : {1, 9, 16, 37}) {
        test::Numbers numbers{9};
        const auto n = std::size_t(pixels);
        const auto mu = numbers.many(n, Fill::ordinary), share = numbers.many(n, Fill::ordinary);
        auto log_sigma = numbers.many(n, Fill::ordinary);
        for (float& v : log_sigma) v *= 8;  // past its limits, -6 and 1
        test::Guarded a{n}, b{n}, c{n}, sigma{n};
        std::ranges::copy(mu, a.data());
        std::ranges::copy(log_sigma, b.data());
        vector_kernels().weigh_rows(
            {a.data(), b.data(), c.data(), share.data(), 0.7F, -6, 1, pixels});
        vector_kernels().scaled_exp(log_sigma.data(), 0.9F, sigma.data(), n);
        EXPECT_TRUE(a.intact() && b.intact() && c.intact() && sigma.intact());
        for (std::size_t i = 0; i < n; ++i) {
            const double w = 0.7 * share[i], s = std::clamp(double(log_sigma[i]), -6.0, 1.0);
            EXPECT_NEAR(a.data()[i], w * mu[i], 1e-6);
            EXPECT_NEAR(b.data()[i], w * s, 1e-6);
            EXPECT_NEAR(c.data()[i], w * (std::exp(2 * s) + double(mu[i]) * mu[i]), 1e-5);
            EXPECT_NEAR(sigma.data()[i], 0.9 * std::exp(double(log_sigma[i])),
                        1e-6 * std::exp(double(log_sigma[i])));
        }
    }
}

TEST(Bf16, RoundingIsToTheNearestEven) {
    const auto back = [](std::uint16_t v) { return std::bit_cast<float>(std::uint32_t(v) << 16); };
    EXPECT_EQ(back(to_bf16(1.0F)), 1.0F);
    EXPECT_EQ(back(to_bf16(1.0F + 0x1p-8F)), 1.0F) << "a tie goes to the even one";
    EXPECT_EQ(back(to_bf16(1.0F + 0x1.8p-7F)), 1.0F + 0x1p-6F);
    EXPECT_EQ(back(to_bf16(-3.14159F)), -3.140625F);
}

void expect_narrowed(const Bf16Kernels& kernels) {
    test::Numbers numbers{2};
    for (const int channels : {1, 2, 5, 16, 21, 64}) {
        const auto n = std::size_t(channels), pairs = (n + 1) / 2;
        const auto in = numbers.many(3 * n, Fill::mixed);
        std::vector<std::uint32_t> out(3 * pairs + 1, 77);
        kernels.pixels_to_bf16(in.data(), 3, channels, out.data());
        EXPECT_EQ(out.back(), 77U);
        for (std::size_t p = 0; p < 3; ++p)
            for (std::size_t c = 0; c < n; ++c) {
                const std::uint32_t pair = out[p * pairs + c / 2];
                EXPECT_EQ(std::uint16_t(c % 2 == 0 ? pair : pair >> 16), to_bf16(in[p * n + c]));
            }
        std::vector<std::uint16_t> row(3 * n + 1, 77);
        kernels.row_to_bf16(in.data(), 3 * n, row.data());
        EXPECT_EQ(row.back(), 77);
        for (std::size_t i = 0; i < 3 * n; ++i) EXPECT_EQ(row[i], to_bf16(in[i]));
    }
}
TEST(Bf16, RowsAreNarrowedNumberByNumber) {
    expect_narrowed(plain::bf16_kernels());
    if (bf16_kernels() == nullptr) GTEST_SKIP() << "this processor has no bf16 products";
    expect_narrowed(*bf16_kernels());
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
        for (std::size_t s = 0; s < 2; ++s)
            stretches[s] = {in.data() + s * kPairs, 3, kPairs, length};
    }
    /// The outputs, as float32 or as bf16, of each row one behind the other; how many were written
    /// outside of them is to be none.
    std::vector<float> run(const Bf16Kernels& kernels, bool narrow, bool relu) {
        const int units = narrow ? (outputs + 1) / 2 : outputs;
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
        area.narrow = narrow;
        area.out = out.data();
        area.out_step = units;
        area.out_pitch = width * units;
        kernels.dot_area(area);
        EXPECT_TRUE(out.intact()) << outputs;
        const auto pixels = std::size_t(kHeight * width);
        std::vector<float> wide(pixels * std::size_t(outputs));
        const auto* numbers = reinterpret_cast<const std::uint16_t*>(out.data());
        for (std::size_t p = 0; p < pixels; ++p)
            for (std::size_t o = 0; o < std::size_t(outputs); ++o)
                wide[p * std::size_t(outputs) + o] =
                    narrow ? from_bf16(numbers[p * 2 * std::size_t(units) + o])
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
                for (const bool narrow : {false, true})
                    for (const bool relu : {false, true}) {
                        const auto fast = work.run(kernels, narrow, relu);
                        const auto plain = work.run(plain::bf16_kernels(), narrow, relu);
                        // The processor may sum a pair's two products before it adds them: one
                        // rounding elsewhere; and one that ends in another bf16 number.
                        const double share = narrow ? 1.0 / 128 : 1e-6;
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

/// Offsets, a hidden layer and two outputs at once, against the same in double.
void expect_hidden_rows(const Bf16Kernels& kernels) {
    constexpr int kColumns = 9;
    for (const int width : {12, 32})
        for (const int outputs : {20, 32})
            for (const int pixels : {1, 16, 17, 32, 61}) {
                test::Numbers numbers{4};
                const auto n = std::size_t(width), o = std::size_t(outputs),
                           count = std::size_t(pixels);
                const auto sums = numbers.many(kColumns * n, Fill::ordinary),
                           dx = numbers.many(count, Fill::ordinary),
                           base = numbers.many(n, Fill::ordinary),
                           slope = numbers.many(n, Fill::ordinary),
                           last = numbers.many(2 * o, Fill::ordinary);
                std::vector<float> hidden = numbers.many(n * o, Fill::ordinary), bias(32);
                for (float& v : bias) v = numbers.next(Fill::ordinary);
                const float last_bias[] = {0.25F, -1};
                std::vector<int> column;
                for (int p = 0; p < pixels; ++p) column.push_back(p * 5 % kColumns);
                std::vector<std::uint32_t> narrow(kColumns * n / 2), weight(n / 2 * 32);
                kernels.pixels_to_bf16(sums.data(), kColumns, width, narrow.data());
                for (std::size_t k = 0; k < n; ++k)
                    for (std::size_t i = 0; i < o; ++i)
                        weight[k / 2 * 32 + i] |= std::uint32_t{to_bf16(hidden[k * o + i])}
                                                  << (k % 2 * 16);
                test::Guarded mu{count}, log_sigma{count};
                ASSERT_TRUE(
                    kernels.hidden_rows({{narrow.data(), 0, column.data(), dx.data(), base.data(),
                                          slope.data(), pixels, width, nullptr},
                                         weight.data(),
                                         bias.data(),
                                         outputs,
                                         last.data(),
                                         last_bias,
                                         mu.data(),
                                         log_sigma.data()}));
                EXPECT_TRUE(mu.intact() && log_sigma.intact());
                for (std::size_t p = 0; p < count; ++p) {
                    double two[] = {last_bias[0], last_bias[1]};
                    for (std::size_t i = 0; i < o; ++i) {
                        double sum = bias[i];
                        for (std::size_t k = 0; k < n; ++k)
                            sum += hidden[k * o + i] *
                                   std::max(0.0, double(sums[std::size_t(column[p]) * n + k]) +
                                                     base[k] + double(dx[p]) * slope[k]);
                        for (std::size_t w = 0; w < 2; ++w)
                            two[w] += last[w * o + i] * std::max(0.0, sum);
                    }
                    // Of terms that add up to some 20.
                    EXPECT_NEAR(mu.data()[p], two[0], 0.1) << width << " " << outputs;
                    EXPECT_NEAR(log_sigma.data()[p], two[1], 0.1) << width << " " << outputs;
                }
            }
}
TEST(Bf16, HiddenRowsAreTheLayersOneByOne) {
    if (bf16_kernels() == nullptr) GTEST_SKIP() << "this processor has no bf16 products";
    expect_hidden_rows(avx512_bf16::bf16_kernels());
    if (amx_kernels() != nullptr) expect_hidden_rows(*amx_kernels());
}

/// The mean of four samples, of float32 and bf16 alike; the last sample stands for those behind it.
TEST(VectorKernels, DoubledRowsAreMeansOfSamples) {
    constexpr int kSamples = 5;
    for (const int channels : {2, 8, 16, 22, 64}) {
        test::Numbers numbers{8};
        const auto n = std::size_t(channels);
        const auto above = numbers.many(kSamples * n, Fill::ordinary),
                   under = numbers.many(kSamples * n, Fill::ordinary);
        std::vector<float> out(9 * n);
        vector_kernels().double_row(
            {above.data(), under.data(), kSamples - 1, 1, 10, channels, out.data()});
        std::vector<std::uint32_t> narrow_above(kSamples * n / 2), narrow_under(kSamples * n / 2),
            narrow(9 * n / 2);
        plain::bf16_kernels().pixels_to_bf16(above.data(), kSamples, channels, narrow_above.data());
        plain::bf16_kernels().pixels_to_bf16(under.data(), kSamples, channels, narrow_under.data());
        const auto expect_means = [&](const Bf16Kernels& kernels) {
            kernels.double_row({narrow_above.data(), narrow_under.data(), kSamples - 1, 1, 10,
                                channels, narrow.data()});
            const auto* doubled = reinterpret_cast<const std::uint16_t*>(narrow.data());
            for (std::size_t i = 0; i < out.size(); ++i)
                ASSERT_NEAR(from_bf16(doubled[i]), out[i], 1.0 / 64) << channels;
        };
        expect_means(plain::bf16_kernels());
        if (bf16_kernels() != nullptr) expect_means(*bf16_kernels());
        for (int x = 1; x < 10; ++x)
            for (std::size_t c = 0; c < n; ++c) {
                const auto left = std::size_t(x / 2) * n + c,
                           right = std::size_t(std::min((x + 1) / 2, kSamples - 1)) * n + c;
                const double mean =
                    (double(above[left]) + above[right] + under[left] + under[right]) / 4;
                ASSERT_NEAR(out[std::size_t(x - 1) * n + c], mean, 1e-6);
            }
    }
}

}  // namespace
}  // namespace eventide
