// The element-wise kernels against double, at every length and with numbers that saturate.
#include "src/kernels/bf16_kernels.h"
#include "src/kernels/plain/activations.h"
#include "src/kernels/vector_kernels.h"
#include "tests/nn/fills.h"

#include <gtest/gtest.h>

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
        std::copy(h.begin(), h.end(), out.data());
        k.reset_state(a.data(), n, out.data(), n, n, 1);
        expect([&](std::size_t i) { return plain::sigmoid(double(a[i])) * h[i]; }, kGateTolerance,
               "reset");
        k.update_state(h.data(), a.data(), n, b.data(), out.data(), n, 1);
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
        test::Guarded next{count}, one{count}, joined{2 * count}, alone{2 * count};
        k.update_state(h.data(), gates.data(), 2 * channels, candidate.data(), next.data(),
                       channels, kPixels);
        std::copy(gates.begin(), gates.end(), joined.data());
        std::copy(gates.begin(), gates.end(), alone.data());
        k.reset_state(gates.data() + c, 2 * channels, joined.data() + c, 2 * channels, channels,
                      kPixels);
        for (std::size_t p = 0; p < kPixels; ++p) {
            k.update_state(h.data() + p * c, gates.data() + 2 * p * c, channels,
                           candidate.data() + p * c, one.data() + p * c, channels, 1);
            k.reset_state(gates.data() + (2 * p + 1) * c, channels, alone.data() + (2 * p + 1) * c,
                          channels, channels, 1);
        }
        EXPECT_TRUE(next.intact() && joined.intact());
        EXPECT_TRUE(std::equal(next.data(), next.data() + count, one.data())) << channels;
        EXPECT_TRUE(std::equal(joined.data(), joined.data() + 2 * count, alone.data())) << channels;
    }
}

TEST(VectorKernels, SaturatedGatesAreExact) {
    const float h = 0.25F, r = 0.5F;
    float out = 0;
    for (const float big : {60.0F, 1e30F, std::numeric_limits<float>::max()}) {
        const float small = -big;
        vector_kernels().update_state(&h, &big, 1, &big, &out, 1, 1);
        EXPECT_EQ(out, 1.0F);
        vector_kernels().update_state(&h, &small, 1, &r, &out, 1, 1);
        EXPECT_NEAR(out, h, 1e-7) << "a closed gate keeps the state";
    }
}

TEST(VectorKernels, TwoOutputsAreTwoSumsOfProducts) {
    test::Numbers numbers{3};
    for (const int width : {1, 7, 16, 30, 64, 128}) {
        const auto n = std::size_t(width);
        const auto in = numbers.many(5 * n, Fill::ordinary),
                   weight = numbers.many(2 * n, Fill::ordinary);
        const float bias[] = {0.5F, -2};
        test::Guarded out{10};
        vector_kernels().two_outputs(in.data(), weight.data(), bias, 5, width, out.data());
        EXPECT_TRUE(out.intact());
        for (std::size_t p = 0; p < 5; ++p)
            for (std::size_t o = 0; o < 2; ++o) {
                double sum = bias[o];
                for (std::size_t i = 0; i < n; ++i)
                    sum += double(in[p * n + i]) * weight[o * n + i];
                EXPECT_NEAR(out.data()[2 * p + o], sum, 1e-5);
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

TEST(Bf16, TheProcessorsProductsAreThePlainOnes) {
    if (bf16_kernels() == nullptr) GTEST_SKIP() << "this processor has no bf16 products";
    test::Numbers numbers{5};
    constexpr int kPixels = 17, kLength = 40;
    for (const int outputs : {1, 8, 9, 16, 32, 40}) {
        const std::size_t packed = packed_size(1, kLength, outputs, bf16_lanes(outputs));
        std::vector<std::uint32_t> in(kPixels * kLength), weight(packed);
        for (auto* words : {&in, &weight})
            for (std::uint32_t& word : *words)
                word = to_bf16(numbers.next(Fill::ordinary)) |
                       std::uint32_t{to_bf16(numbers.next(Fill::ordinary))} << 16;
        const std::vector<float> bias(packed / kLength, 0.25F);
        test::Guarded fast{std::size_t(kPixels * outputs)}, plain{std::size_t(kPixels * outputs)};
        Bf16DotRows rows{in.data(),     0,           kLength, 1,       kLength, kPixels, outputs,
                         weight.data(), bias.data(), true,    nullptr, outputs};
        rows.out = fast.data();
        bf16_kernels()->dot_rows(rows);
        rows.out = plain.data();
        plain::bf16_kernels().dot_rows(rows);
        EXPECT_TRUE(fast.intact() && plain.intact()) << outputs;
        // The processor may sum a pair's two products before it adds them: one rounding elsewhere.
        for (int i = 0; i < kPixels * outputs; ++i)
            EXPECT_NEAR(fast.data()[i], plain.data()[i], 1e-5) << outputs;
    }
}

}  // namespace
}  // namespace eventide
