// The element-wise kernels against double, at every length and with numbers that saturate.
#include "src/kernels/bf16_kernels.h"
#include "src/kernels/plain/activations.h"
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

/// A few units in the last place of numbers up to 1: exp within 1 ulp, one division, one sum.
constexpr double kGateTolerance = 4e-7;

double limit(double exact, double tolerance) {
    return tolerance * std::max(1.0, std::abs(exact));
}

class Lengths : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(VectorKernels, Lengths, testing::Values(1, 3, 8, 15, 16, 17, 24, 64, 85));

TEST_P(Lengths, GatesAndActivationsAgreeWithDouble) {
    with_each([&](const VectorKernels& k) {
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
            k.compress(a.data(), out.data(), count, 0);
            expect([&](std::size_t i) { return plain::compress(double(a[i])); }, 3e-7, "compress");
            auto gates = a, candidate = b;
            k.sigmoid(gates.data(), count);
            k.reset_state(gates.data(), n, h.data(), out.data(), n, 1);
            expect([&](std::size_t i) { return plain::sigmoid(double(a[i])) * h[i]; },
                   kGateTolerance, "reset");
            k.update_state(h.data(), gates.data(), n, candidate.data(), out.data(), n, 1);
            expect(
                [&](std::size_t i) {
                    return h[i] + plain::sigmoid(double(a[i])) * (std::tanh(double(b[i])) - h[i]);
                },
                2 * kGateTolerance, "update");
            // What one layer gives where there is no reset gate: [a; 2 b].
            std::vector<float> halves = a;
            for (const float v : b) halves.push_back(2 * v);
            k.sigmoid(halves.data(), 2 * count);
            k.update_light(h.data(), halves.data(), out.data(), n, 1);
            expect(
                [&](std::size_t i) {
                    return h[i] + plain::sigmoid(double(a[i])) * (std::tanh(double(b[i])) - h[i]);
                },
                2 * kGateTolerance, "update of halves");
            k.add_relu(a.data(), b.data(), out.data(), count);
            expect([&](std::size_t i) { return plain::relu(double(a[i]) + b[i]); }, 1e-7, "add");
            k.elu(a.data(), out.data(), count);
            expect([&](std::size_t i) { return plain::elu(double(a[i])); }, 3e-7, "elu");
        }
    });
}

TEST_P(Lengths, NearIsEveryNumberWithinTheBound) {
    with_each([&](const VectorKernels& k) {
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
    });
}

/// Gates of the network lie beside each other, [u; r], and a row of pixels is one call.
TEST(VectorKernels, RowsOfGatesAreTheirPixels) {
    with_each([&](const VectorKernels& k) {
        for (const int channels : {1, 4, 8, 12, 16, 24, 40}) {
            constexpr int kPixels = 5;
            const auto c = std::size_t(channels), count = kPixels * c;
            test::Numbers numbers{11};
            const auto gates = numbers.many(2 * count, Fill::ordinary),
                       candidate = numbers.many(count, Fill::ordinary),
                       h = numbers.many(count, Fill::ordinary);
            test::Guarded next{count}, one{count}, kept{count}, alone{count}, light{count},
                light_alone{count};
            auto row = candidate, pixels = candidate;
            k.update_state(h.data(), gates.data(), 2 * channels, row.data(), next.data(), channels,
                           kPixels);
            k.update_light(h.data(), gates.data(), light.data(), channels, kPixels);
            k.reset_state(gates.data() + c, 2 * channels, h.data(), kept.data(), channels, kPixels);
            for (std::size_t p = 0; p < kPixels; ++p) {
                k.update_state(h.data() + p * c, gates.data() + 2 * p * c, channels,
                               pixels.data() + p * c, one.data() + p * c, channels, 1);
                k.reset_state(gates.data() + (2 * p + 1) * c, channels, h.data() + p * c,
                              alone.data() + p * c, channels, 1);
                k.update_light(h.data() + p * c, gates.data() + 2 * p * c,
                               light_alone.data() + p * c, channels, 1);
            }
            EXPECT_TRUE(next.intact() && kept.intact() && light.intact());
            EXPECT_TRUE(std::equal(light.data(), light.data() + count, light_alone.data()))
                << channels;
            EXPECT_TRUE(std::equal(next.data(), next.data() + count, one.data())) << channels;
            EXPECT_TRUE(std::equal(kept.data(), kept.data() + count, alone.data())) << channels;
        }
    });
}

TEST(VectorKernels, SaturatedGatesAreExact) {
    with_each([&](const VectorKernels& k) {
        const float h = 0.25F, r = 0.5F;
        float out = 0;
        for (const float big : {60.0F, 1e30F, std::numeric_limits<float>::max()}) {
            float open = big, closed = -big, full = big, candidate = r;
            k.sigmoid(&open, 1);
            k.sigmoid(&closed, 1);
            k.update_state(&h, &open, 1, &full, &out, 1, 1);
            EXPECT_EQ(out, 1.0F);
            k.update_state(&h, &closed, 1, &candidate, &out, 1, 1);
            EXPECT_NEAR(out, h, 1e-7) << "a closed gate keeps the state";
        }
    });
}

TEST(VectorKernels, NormsAreScaledShiftedAndJoinedBeforeTheElu) {
    with_each([&](const VectorKernels& k) {
        constexpr std::size_t kPixels = 3;
        for (const int channels : {1, 5, 8, 16, 24, 37}) {
            test::Numbers numbers{13};
            const auto c = std::size_t(channels), count = kPixels * c;
            const auto a = numbers.many(count, Fill::ordinary),
                       scale = numbers.many(c, Fill::ordinary),
                       shift = numbers.many(c, Fill::ordinary),
                       skip = numbers.many(count, Fill::ordinary);
            for (const bool joined : {false, true}) {
                test::Guarded out{count};
                k.norm_elu(a.data(), scale.data(), shift.data(), joined ? skip.data() : nullptr,
                           out.data(), kPixels, channels);
                EXPECT_TRUE(out.intact()) << channels;
                for (std::size_t i = 0; i < count; ++i) {
                    const double sum = double(a[i]) * scale[i % c] + shift[i % c];
                    ASSERT_NEAR(out.data()[i], plain::elu(sum + (joined ? skip[i] : 0)), 1e-6)
                        << channels << " " << i;
                }
            }
        }
    });
}

/// Five samples a row, of which rows of pixels begin and end on a sample or between two.
struct DoubledRow {
    static constexpr int kSamples = 5;
    std::size_t channels;
    std::vector<float> above, under;

    explicit DoubledRow(int c) : channels(std::size_t(c)) {
        test::Numbers numbers{8};
        above = numbers.many(kSamples * channels, Fill::ordinary);
        under = numbers.many(kSamples * channels, Fill::ordinary);
    }
    double exact(int x, std::size_t c) const {
        const auto left = std::size_t(x / 2) * channels + c,
                   right = std::size_t(std::min((x + 1) / 2, kSamples - 1)) * channels + c;
        return (double(above[left]) + above[right] + under[left] + under[right]) / 4;
    }
    void expect_floats(const VectorKernels& k, int x0, int x1) const {
        test::Guarded out{std::size_t(x1 - x0) * channels};
        k.double_row({above.data(), under.data(), kSamples - 1, x0, x1, int(channels), out.data()});
        EXPECT_TRUE(out.intact()) << x0 << " to " << x1;
        for (int x = x0; x < x1; ++x)
            for (std::size_t c = 0; c < channels; ++c)
                ASSERT_NEAR(out.data()[std::size_t(x - x0) * channels + c], exact(x, c), 1e-6)
                    << x << " of " << x0 << " to " << x1;
    }
    void expect_bf16(const Bf16Kernels& k, int x0, int x1) const {
        std::vector<std::uint32_t> a(above.size() / 2), b(a.size());
        k.pixels_to_bf16(above.data(), kSamples, int(channels), a.data());
        k.pixels_to_bf16(under.data(), kSamples, int(channels), b.data());
        test::Guarded out{std::size_t(x1 - x0) * channels / 2};
        k.double_row({a.data(), b.data(), kSamples - 1, x0, x1, int(channels), out.data()});
        EXPECT_TRUE(out.intact()) << x0 << " to " << x1;
        const auto* numbers = reinterpret_cast<const std::uint16_t*>(out.data());
        for (int x = x0; x < x1; ++x)
            for (std::size_t c = 0; c < channels; ++c)
                ASSERT_NEAR(from_bf16(numbers[std::size_t(x - x0) * channels + c]), exact(x, c),
                            1.0 / 128)
                    << x << " of " << x0 << " to " << x1;
    }
};

/// The mean of four samples, of float32 and bf16 alike; the last sample stands for those behind it.
TEST(VectorKernels, DoubledRowsAreMeansOfSamples) {
    for (const int channels : {2, 8, 16, 22, 64}) {
        const DoubledRow row{channels};
        for (const auto& [x0, x1] : {std::pair{0, 10}, {1, 10}, {0, 9}, {3, 8}, {4, 7}, {6, 7}}) {
            with_each([&](const VectorKernels& k) { row.expect_floats(k, x0, x1); });
            row.expect_bf16(plain::bf16_kernels(), x0, x1);
            for (const Bf16Kernels* k : test::all_bf16_kernels()) row.expect_bf16(*k, x0, x1);
        }
    }
}

TEST(VectorKernels, HaveNoMoreInstructionsThanTheyMay) {
    EXPECT_LE(vector_kernels(Instructions::sse4).lanes, 4);
    EXPECT_LE(vector_kernels(Instructions::avx2).lanes, 8);
    for (const Instructions most : {Instructions::sse4, Instructions::avx2}) {
        EXPECT_FALSE(vector_kernels(most).by_quads);
        EXPECT_EQ(bf16_kernels(most), nullptr);
    }
    EXPECT_EQ(amx_kernels(Instructions::avx512), nullptr);
}

}  // namespace
}  // namespace eventide
