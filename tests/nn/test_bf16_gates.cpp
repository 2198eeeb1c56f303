// The gates of states that layers read in bf16, and the input's compression, against double
// precision.
#include "src/kernels/bf16_gates.h"

#include "src/kernels/plain/activations.h"
#include "tests/nn/fills.h"
#include "tests/nn/instruction_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace eventide {
namespace {

using test::Fill;

constexpr int kPixels = 5;
constexpr double kGate = 1e-6;           // of a gate, which lies between 0 and 1
constexpr double kRounding = 1.0 / 128;  // to bf16, of the state and of the product
constexpr std::uint16_t kMark = 0x4d4d;  // past a row: nobody's

template <typename Body>
void with_each_bf16(const Body& body) {
    std::vector<const Bf16Kernels*> all = test::all_bf16_kernels();
    all.push_back(&plain::bf16_kernels());
    for (const Bf16Kernels* kernels : all)
        for (const int channels : {1, 4, 5, 8, 12, 16, 21, 40}) {
            SCOPED_TRACE(std::string{kernels->name} + ", " + std::to_string(channels));
            body(*kernels, channels);
        }
}

std::size_t even(int channels) {
    return std::size_t(channels + 1) / 2 * 2;
}

/// [pixels][C], with a zero beside the last of an odd C.
std::vector<std::uint16_t> as_bf16(const std::vector<float>& values, int channels) {
    const auto c = std::size_t(channels);
    std::vector<std::uint16_t> rounded(values.size() / c * even(channels));
    for (std::size_t i = 0; i < values.size(); ++i)
        rounded[i / c * even(channels) + i % c] = to_bf16(values[i]);
    return rounded;
}

/// Sums of a layer with two halves, [u; r] or [u; 2 v], and the state they act on.
struct Row {
    int channels;
    std::vector<float> sums, h;

    Row(int c, Fill fill) : channels(c) {
        test::Numbers numbers{23};
        sums = numbers.many(2 * std::size_t{kPixels} * std::size_t(c), fill);
        h = numbers.many(std::size_t{kPixels} * std::size_t(c), Fill::ordinary);
    }
    double sum(int half, std::size_t i) const {
        const auto c = std::size_t(channels);
        return double(sums[(2 * (i / c) + std::size_t(half)) * c + i % c]);
    }

    std::vector<std::uint16_t> kept(const Bf16Kernels& k, int first, int pixels) const {
        const std::vector<std::uint16_t> read = as_bf16(h, channels);
        std::vector<std::uint16_t> kept(read.size() + 1, kMark);
        const auto at = std::size_t(first) * even(channels);
        k.keep_row({.r = sums.data() + (2 * first + 1) * channels,
                    .r_step = 2 * std::ptrdiff_t{channels},
                    .h = read.data() + at,
                    .kept = kept.data() + at,
                    .channels = channels,
                    .pixels = pixels});
        return kept;
    }
    struct Next {
        std::vector<float> h;
        std::vector<std::uint16_t> rounded;
    };
    Next updated(const Bf16Kernels& k, bool is_doubled, int first, int pixels) const {
        Next next{h, std::vector<std::uint16_t>(as_bf16(h, channels).size() + 1, kMark)};
        const std::ptrdiff_t step = 2 * std::ptrdiff_t{channels};
        k.update_row({.u = sums.data() + first * step,
                      .v = sums.data() + first * step + channels,
                      .u_step = step,
                      .v_step = step,
                      .is_doubled = is_doubled,
                      .h = next.h.data() + first * channels,
                      .rounded = next.rounded.data() + std::size_t(first) * even(channels),
                      .channels = channels,
                      .pixels = pixels});
        return next;
    }
};

TEST(Bf16Gates, KeepWhatTheResetGateLetsThrough) {
    with_each_bf16([](const Bf16Kernels& k, int channels) {
        for (const Fill fill : test::kFills) {
            const Row row{channels, fill};
            const auto kept = row.kept(k, 0, kPixels);
            EXPECT_EQ(kept.back(), kMark);
            for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
                const std::size_t c = i % even(channels), p = i / even(channels);
                if (c == std::size_t(channels)) {
                    EXPECT_EQ(kept[i], 0) << "beside the last of an odd number";
                    continue;
                }
                const std::size_t at = p * std::size_t(channels) + c;
                const double exact = plain::sigmoid(row.sum(1, at)) * double(row.h[at]);
                ASSERT_NEAR(from_bf16(kept[i]), exact, std::abs(exact) * kRounding + kGate);
            }
        }
    });
}

TEST(Bf16Gates, UpdateTheExactStateAndRoundItOnce) {
    with_each_bf16([](const Bf16Kernels& k, int channels) {
        for (const Fill fill : test::kFills)
            for (const bool is_doubled : {false, true}) {
                const Row row{channels, fill};
                const Row::Next next = row.updated(k, is_doubled, 0, kPixels);
                for (std::size_t i = 0; i < row.h.size(); ++i) {
                    const double v = row.sum(1, i) / (is_doubled ? 2 : 1), h = double(row.h[i]);
                    ASSERT_NEAR(next.h[i], h + plain::sigmoid(row.sum(0, i)) * (std::tanh(v) - h),
                                2 * kGate);
                }
                auto rounded = as_bf16(next.h, channels);
                rounded.push_back(kMark);
                EXPECT_EQ(next.rounded, rounded);
            }
    });
}

/// A tile's states must not depend on where a stretch of masked pixels begins.
TEST(Bf16Gates, ARowIsItsPixels) {
    with_each_bf16([](const Bf16Kernels& k, int channels) {
        const Row row{channels, Fill::ordinary};
        const auto kept = row.kept(k, 0, kPixels);
        const Row::Next next = row.updated(k, true, 0, kPixels);
        const auto c = std::size_t(channels), step = even(channels);
        for (int p = 0; p < kPixels; ++p) {
            const auto at = std::ptrdiff_t(std::size_t(p) * step),
                       exact = std::ptrdiff_t(std::size_t(p) * c);
            const auto alone = row.kept(k, p, 1);
            EXPECT_TRUE(std::equal(alone.begin() + at, alone.begin() + at + std::ptrdiff_t(step),
                                   kept.begin() + at));
            const Row::Next one = row.updated(k, true, p, 1);
            EXPECT_TRUE(std::equal(one.h.begin() + exact, one.h.begin() + exact + channels,
                                   next.h.begin() + exact));
            EXPECT_EQ(std::ranges::count(one.rounded, kMark),
                      std::ptrdiff_t(one.rounded.size() - step))
                << "its own numbers alone";
        }
    });
}

TEST(Bf16Gates, SaturateWithoutLosingTheState) {
    with_each_bf16([](const Bf16Kernels& k, int channels) {
        for (const float big : {60.0F, 1e30F, std::numeric_limits<float>::max()}) {
            Row row{channels, Fill::ordinary};
            const auto set = [&](float u, float v) {
                for (std::size_t i = 0; i < row.sums.size(); ++i)
                    row.sums[i] = i / std::size_t(channels) % 2 == 0 ? u : v;
            };
            set(big, big);
            for (const float h : row.updated(k, false, 0, kPixels).h) EXPECT_NEAR(h, 1, 1e-7);
            set(-big, 0.5F);
            EXPECT_EQ(row.updated(k, false, 0, kPixels).h, row.h) << "a closed gate keeps it";
        }
    });
}

/// Few, and more than kernels take at a time.
constexpr std::size_t kCompressed[] = {kPixels, 1100};

TEST(Bf16Gates, CompressTheInputIntoOneMap) {
    with_each_bf16([](const Bf16Kernels& k, int channels) {
        const auto c = std::size_t(channels), size = even(channels) + 6;
        for (const std::size_t pixels : kCompressed)
            for (const Fill fill : test::kFills) {
                test::Numbers numbers{29};
                const auto in = numbers.many(c * pixels, fill);
                std::vector<std::uint16_t> out(size * pixels + 1, kMark);
                k.compress_row({.in = in.data(),
                                .pixels = int(pixels),
                                .channels = channels,
                                .out = out.data(),
                                .size = int(size)});
                EXPECT_EQ(out.back(), kMark);
                for (std::size_t i = 0; i < size * pixels; ++i) {
                    const float v = i % size < c ? in[i / size * c + i % size] : 0;
                    const double exact = plain::compress(double(v));
                    ASSERT_NEAR(from_bf16(out[i]), exact, std::abs(exact) / 256 + 1e-7) << v;
                    ASSERT_TRUE(v != 0 || from_bf16(out[i]) == 0) << "nothing happened there";
                }
            }
    });
}

TEST(Bf16Gates, CompressTheInputIntoSeveralMaps) {
    with_each_bf16([](const Bf16Kernels& k, int channels) {
        constexpr std::size_t kSize = 8;
        const std::size_t maps = (std::size_t(channels) + kSize - 1) / kSize;
        if (maps > 4) return;
        for (const std::size_t pixels : kCompressed) {
            const std::size_t plane = pixels * kSize;
            test::Numbers numbers{31};
            const auto in = numbers.many(std::size_t(channels) * pixels, Fill::mixed);
            std::vector<std::uint16_t> one(maps * plane), several(4 * plane, kMark);
            CompressRow row{.in = in.data(),
                            .pixels = int(pixels),
                            .channels = channels,
                            .out = one.data(),
                            .size = int(maps * kSize)};
            k.compress_row(row);
            row.out = several.data();
            row.size = kSize;
            row.maps = int(maps);
            row.plane = std::ptrdiff_t(plane / 2);
            k.compress_row(row);
            for (std::size_t p = 0; p < pixels; ++p)
                for (std::size_t i = 0; i < maps * kSize; ++i)
                    ASSERT_EQ(several[i / kSize * plane + p * kSize + i % kSize],
                              one[p * maps * kSize + i]);
            EXPECT_EQ(std::ranges::count(several, kMark), std::ptrdiff_t((4 - maps) * plane))
                << "behind the last map";
        }
    });
}

}  // namespace
}  // namespace eventide
