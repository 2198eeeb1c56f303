// What the renderer does around its hidden layers, against double.
#include "src/kernels/bf16_kernels.h"
#include "src/kernels/vector_kernels.h"
#include "tests/nn/fills.h"
#include "tests/nn/instruction_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace eventide {
namespace {

using test::Fill;
using test::with_each;

TEST(RenderKernels, TwoOutputsAreTwoSumsOfProducts) {
    with_each([&](const VectorKernels& k) {
        test::Numbers numbers{3};
        for (const int width : {1, 7, 16, 30, 64, 128})
            for (const int pixels : {1, 5, 16, 21, 56}) {
                const auto n = std::size_t(width), count = std::size_t(pixels);
                const auto in = numbers.many(count * n, Fill::ordinary),
                           weight = numbers.many(2 * n, Fill::ordinary);
                const float bias[] = {0.5F, -2};
                test::Guarded first{count}, second{count};
                k.two_outputs(
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
    });
}

TEST(RenderKernels, OffsetsAreAddedToTheSumsOfTheirColumn) {
    with_each([&](const VectorKernels& k) {
        constexpr int kPixels = 7;
        const int column[kPixels] = {0, 0, 1, 1, 2, 4, 4};
        for (const int width : {1, 8, 17, 32, 40}) {
            test::Numbers numbers{6};
            const auto n = std::size_t(width), step = (n + 1) / 2 * 2;
            const auto sums = numbers.many(5 * n, Fill::ordinary),
                       dx = numbers.many(kPixels, Fill::ordinary),
                       base = numbers.many(n, Fill::ordinary),
                       slope = numbers.many(n, Fill::ordinary);
            std::vector<float> exact;
            for (std::size_t p = 0; p < kPixels; ++p)
                for (std::size_t c = 0; c < n; ++c)
                    exact.push_back(std::max(
                        0.0F, sums[std::size_t(column[p]) * n + c] + base[c] + dx[p] * slope[c]));
            test::Guarded out{kPixels * n};
            k.offset_rows({sums.data(), 0, column, dx.data(), base.data(), slope.data(), kPixels,
                           width, out.data()});
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
            for (const Bf16Kernels* kernels : test::all_bf16_kernels()) expect_rows(*kernels);
        }
    });
}

TEST(RenderKernels, ASampleIsWeighedByItsShare) {
    with_each([&](const VectorKernels& k) {
        for (const int pixels : {1, 9, 16, 37}) {
            test::Numbers numbers{9};
            const auto n = std::size_t(pixels);
            const auto mu = numbers.many(n, Fill::ordinary),
                       share = numbers.many(n, Fill::ordinary);
            auto log_sigma = numbers.many(n, Fill::ordinary);
            for (float& v : log_sigma) v *= 8;  // past its limits, -6 and 1
            test::Guarded a{n}, b{n}, c{n}, sigma{n};
            std::ranges::copy(mu, a.data());
            std::ranges::copy(log_sigma, b.data());
            k.weigh_rows({a.data(), b.data(), c.data(), share.data(), 0.7F, -6, 1, pixels});
            k.scaled_exp(log_sigma.data(), 0.9F, sigma.data(), n);
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
    });
}

/// Where pixels lie beside their samples: in frames of the sensor's size all at one place, which
/// kernels take out of their loops.
enum class Places { apart, alike, alike_but_the_last };

std::vector<float> places(Places how, std::size_t count, test::Numbers& numbers) {
    if (how == Places::apart) return numbers.many(count, Fill::ordinary);
    std::vector<float> dx(count, 0.25F);
    if (how == Places::alike_but_the_last && count > 0) dx.back() = -0.75F;
    return dx;
}
constexpr Places kAllPlaces[] = {Places::apart, Places::alike, Places::alike_but_the_last};

/// Offsets, a hidden layer and two outputs at once, against the same in double.
void expect_hidden_rows(const Bf16Kernels& kernels, Places how) {
    constexpr int kColumns = 9;
    for (const auto& [width, outputs] :
         {std::pair{12, 20}, {12, 32}, {32, 20}, {32, 32}, {16, 16}, {6, 16}, {16, 9}})
        for (const int pixels : {0, 1, 16, 17, 32, 61}) {
            test::Numbers numbers{4};
            const auto n = std::size_t(width), o = std::size_t(outputs),
                       count = std::size_t(pixels), lanes = std::size_t(outputs > 16 ? 32 : 16);
            const auto sums = numbers.many(kColumns * n, Fill::ordinary),
                       dx = places(how, count, numbers), base = numbers.many(n, Fill::ordinary),
                       slope = numbers.many(n, Fill::ordinary),
                       last = numbers.many(2 * o, Fill::ordinary);
            std::vector<float> hidden = numbers.many(n * o, Fill::ordinary), bias(32);
            for (float& v : bias) v = numbers.next(Fill::ordinary);
            const float last_bias[] = {0.25F, -1};
            std::vector<int> column;
            for (int p = 0; p < pixels; ++p) column.push_back(p * 5 % kColumns);
            std::vector<std::uint32_t> narrow(kColumns * n / 2), weight(n / 2 * lanes);
            kernels.pixels_to_bf16(sums.data(), kColumns, width, narrow.data());
            for (std::size_t k = 0; k < n; ++k)
                for (std::size_t i = 0; i < o; ++i)
                    weight[k / 2 * lanes + i] |= std::uint32_t{to_bf16(hidden[k * o + i])}
                                                 << (k % 2 * 16);
            test::Guarded mu{count}, log_sigma{count};
            ASSERT_TRUE(kernels.hidden_rows({{narrow.data(), 0, column.data(), dx.data(),
                                              base.data(), slope.data(), pixels, width, nullptr},
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
TEST(RenderKernels, HiddenRowsAreTheLayersOneByOne) {
    if (bf16_kernels() == nullptr) GTEST_SKIP() << "this processor has no bf16 products";
    for (const Bf16Kernels* kernels : test::all_bf16_kernels())
        for (const Places how : kAllPlaces) expect_hidden_rows(*kernels, how);
}

/// Numbers for layers of `width` and `outputs` at `pixels` pixels, and the same as HiddenRows.
struct FloatRows {
    static constexpr int kColumns = 9;
    std::vector<float> sums, dx, base, slope, hidden, weight, bias, last;
    float last_bias[2] = {0.25F, -1};
    std::vector<int> column;
    int pixels, width, outputs;

    FloatRows(const VectorKernels& kernels, int pixel_count, int inputs, int output_count,
              Places how)
        : pixels(pixel_count), width(inputs), outputs(output_count) {
        test::Numbers numbers{4};
        const auto n = std::size_t(width), o = std::size_t(outputs), count = std::size_t(pixels),
                   lanes = std::size_t(kernels.lanes);
        sums = numbers.many(kColumns * n, Fill::ordinary);
        dx = places(how, count, numbers);
        base = numbers.many(n, Fill::ordinary);
        slope = numbers.many(n, Fill::ordinary);
        last = numbers.many(2 * o, Fill::ordinary);
        hidden = numbers.many(n * o, Fill::ordinary);
        bias = numbers.many(o, Fill::ordinary);
        bias.resize((o + lanes - 1) / lanes * lanes);
        for (int p = 0; p < pixels; ++p) column.push_back(p * 5 % kColumns);
        // As packed_size() says.
        weight.resize(packed_size(1, width, outputs, kernels.lanes));
        auto to = weight.begin();
        for (std::size_t first = 0; first < o;) {
            const std::size_t block = o - first > lanes ? 2 * lanes : lanes;
            for (std::size_t k = 0; k < n; ++k)
                for (std::size_t i = first; i < first + block; ++i)
                    *to++ = i < o ? hidden[k * o + i] : 0;
            first += block;
        }
    }
    HiddenRows rows(std::size_t begin, int count, float* mu, float* log_sigma) const {
        return {{sums.data(), 0, column.data() + begin, dx.data() + begin, base.data(),
                 slope.data(), count, width, nullptr},
                weight.data(),
                bias.data(),
                outputs,
                last.data(),
                last_bias,
                mu,
                log_sigma};
    }
    double expected(std::size_t p, std::size_t which) const {
        const auto n = std::size_t(width), o = std::size_t(outputs);
        double result = last_bias[which];
        for (std::size_t i = 0; i < o; ++i) {
            double sum = bias[i];
            for (std::size_t k = 0; k < n; ++k)
                sum +=
                    hidden[k * o + i] * std::max(0.0, double(sums[std::size_t(column[p]) * n + k]) +
                                                          base[k] + double(dx[p]) * slope[k]);
            result += last[which * o + i] * std::max(0.0, sum);
        }
        return result;
    }
};

TEST(RenderKernels, HiddenRowsOfFloatsAreTheLayersOneByOne) {
    with_each([&](const VectorKernels& k) {
        for (const auto& [width, outputs] :
             {std::pair{32, 32}, {16, 16}, {64, 64}, {32, 20}, {16, 40}, {48, 9}})
            for (const int pixels : {0, 1, 6, 13, 48, 61, 240})
                for (const Places how : kAllPlaces) {
                    const FloatRows r{k, pixels, width, outputs, how};
                    const auto count = std::size_t(pixels);
                    test::Guarded mu{count}, log_sigma{count};
                    ASSERT_TRUE(k.hidden_rows(r.rows(0, pixels, mu.data(), log_sigma.data())));
                    EXPECT_TRUE(mu.intact() && log_sigma.intact());
                    for (std::size_t p = 0; p < count; ++p) {
                        ASSERT_NEAR(mu.data()[p], r.expected(p, 0), 1e-4) << width << outputs;
                        ASSERT_NEAR(log_sigma.data()[p], r.expected(p, 1), 1e-4);
                    }
                }
    });
}

TEST(RenderKernels, WhatAPixelGetsDoesNotDependOnThoseBesideIt) {
    with_each([&](const VectorKernels& k) {
        const FloatRows r{k, 101, 32, 32, Places::apart};
        std::vector<float> mu(101), log_sigma(101);
        ASSERT_TRUE(k.hidden_rows(r.rows(0, 101, mu.data(), log_sigma.data())));
        // Alone, all have the same dx.
        for (std::size_t p = 0; p < mu.size(); ++p) {
            float one = 0, other = 0;
            ASSERT_TRUE(k.hidden_rows(r.rows(p, 1, &one, &other)));
            ASSERT_EQ(one, mu[p]);
            ASSERT_EQ(other, log_sigma[p]);
        }
    });
}

TEST(RenderKernels, HiddenRowsRefuseLayersTheyAreNotMadeFor) {
    with_each([&](const VectorKernels& k) {
        float mu = 7, log_sigma = 7;
        for (const auto& [width, outputs] : {std::pair{96, 32}, {32, 96}}) {
            const FloatRows r{k, 1, width, outputs, Places::alike};
            EXPECT_FALSE(k.hidden_rows(r.rows(0, 1, &mu, &log_sigma)));
        }
        if (k.lanes > 1) {
            const FloatRows r{k, 1, k.lanes + 1, 32, Places::alike};
            EXPECT_FALSE(k.hidden_rows(r.rows(0, 1, &mu, &log_sigma)));
        }
        EXPECT_EQ(mu, 7);
        EXPECT_EQ(log_sigma, 7);
    });
}

TEST(RenderKernels, HiddenRowsOfBf16RefuseLayersTheyAreNotMadeFor) {
    if (bf16_kernels() == nullptr) GTEST_SKIP() << "this processor has no bf16 products";
    const std::vector<std::uint32_t> sums(64), weight(64 * 64);
    const std::vector<float> numbers(256);
    const int column = 0;
    for (const Bf16Kernels* kernels : test::all_bf16_kernels())
        for (const auto& [width, outputs] :
             {std::pair{34, 32}, {7, 32}, {32, 40}, {18, 16}, {7, 16}, {16, 8}}) {
            float mu = 7, log_sigma = 7;
            const OffsetRows offset{sums.data(),    0, &column, numbers.data(), numbers.data(),
                                    numbers.data(), 1, width,   nullptr};
            EXPECT_FALSE(kernels->hidden_rows({offset, weight.data(), numbers.data(), outputs,
                                               numbers.data(), numbers.data(), &mu, &log_sigma}))
                << width << " " << outputs;
            EXPECT_EQ(mu, 7);
            EXPECT_EQ(log_sigma, 7);
        }
}

}  // namespace
}  // namespace eventide
