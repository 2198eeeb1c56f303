// Four pixels x four outputs in a register of AVX-512, against the kernels that take a pixel at a
// time.
#include "src/kernels/bf16_kernels.h"
#include "src/kernels/quad_dots.h"
#include "src/nn/packed_conv.h"
#include "tests/nn/fills.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace eventide {
namespace {

using test::Fill;

/// Two stretches of whole quads over pixels that overlap, and nothing behind the last that is read.
struct Work {
    static constexpr int kHeight = 2;
    int width, step, length, outputs;
    std::vector<std::uint32_t> in, weight;
    std::vector<float> bias;
    std::array<Stretch, 2> stretches;

    Work(int w, int s, int o, bool is_bf16)
        : width(w), step(s), length(std::max(12, 3 * s)), outputs(o) {
        test::Numbers numbers{7};
        const std::ptrdiff_t pitch = std::ptrdiff_t(width - 1) * step + length;
        in.resize(std::size_t(kHeight + 1) * std::size_t(pitch));
        weight.resize(std::size_t(2 * length * outputs));
        for (auto* words : {&in, &weight})
            for (std::uint32_t& word : *words) {
                const float value = numbers.next(Fill::ordinary);
                word = is_bf16 ? to_bf16(value) |
                                     std::uint32_t{to_bf16(numbers.next(Fill::ordinary))} << 16
                               : std::bit_cast<std::uint32_t>(value);
            }
        bias = numbers.many(16, Fill::ordinary);
        for (std::size_t i = 0; i < 2; ++i)
            stretches[i] = {in.data() + std::ptrdiff_t(i) * pitch, step, pitch, length};
    }
    DotArea area(bool narrow, bool relu) const {
        DotArea area;
        area.stretches = stretches.data();
        area.count = 2;
        area.height = kHeight;
        area.width = width;
        area.outputs = outputs;
        area.lanes = 8;
        area.weight = weight.data();
        area.bias = bias.data();
        area.relu = relu;
        area.to_bf16 = narrow;
        area.out_step = narrow ? outputs / 2 : outputs;
        area.out_pitch = width * area.out_step;
        return area;
    }
    template <typename Dot>
    std::vector<float> run(DotArea area, const Dot& dot) const {
        test::Guarded out{std::size_t(kHeight) * std::size_t(area.out_pitch)};
        area.out = out.data();
        dot(area);
        EXPECT_TRUE(out.intact()) << "written outside";
        return {out.data(), out.data() + std::ptrdiff_t(kHeight) * area.out_pitch};
    }
};

template <typename Body>
void over_shapes(bool is_bf16, const Body& body) {
    for (const int outputs : {8, 16})
        for (const int step : {4, 8, 12, 16})
            for (const int width : {4, 5, 16, 23, 32, 50, 75})
                for (const bool relu : {false, true})
                    body(Work{width, step, outputs, is_bf16}, relu);
}

TEST(Quads, FloatsAreThoseOfAvx2BitForBit) {
    if (!vector_kernels().by_quads) GTEST_SKIP() << "this processor has no AVX-512";
    const auto dot_area = vector_kernels(Instructions::avx2).dot_area;
    over_shapes(false, [&](const Work& work, bool relu) {
        const DotArea area = work.area(false, relu);
        ASSERT_TRUE(avx512::takes_quads(area));
        ASSERT_EQ(work.run(area, avx512::dot_quads_f32), work.run(area, dot_area))
            << work.outputs << " outputs, step " << work.step << ", width " << work.width;
    });
}

TEST(Quads, Bf16ProductsAreThePlainOnes) {
    if (!avx512_bf16::there()) GTEST_SKIP() << "this processor has no bf16 products";
    over_shapes(true, [&](const Work& work, bool relu) {
        const DotArea area = work.area(false, relu);
        ASSERT_TRUE(avx512::takes_quads(area));
        const auto fast = work.run(area, avx512::dot_quads_bf16),
                   plain = work.run(area, plain::bf16_kernels().dot_area);
        for (std::size_t i = 0; i < fast.size(); ++i)
            ASSERT_NEAR(fast[i], plain[i], 2e-5 + 1e-6 * std::abs(plain[i]))
                << work.outputs << " outputs, step " << work.step << ", width " << work.width;
        // Narrowed, they are the same numbers rounded.
        const auto narrow = work.run(work.area(true, relu), avx512::dot_quads_bf16);
        const auto* numbers = reinterpret_cast<const std::uint16_t*>(narrow.data());
        for (std::size_t i = 0; i < fast.size(); ++i) ASSERT_EQ(numbers[i], to_bf16(fast[i]));
    });
}

TEST(Quads, AreNotTakenOfWhatTheyDoNotFit) {
    const Work work{16, 8, 8, false};
    EXPECT_TRUE(avx512::takes_quads(work.area(false, false)));
    EXPECT_TRUE(avx512::takes_quads(work.area(true, false)));
    EXPECT_FALSE(avx512::takes_quads(Work(3, 8, 8, false).area(false, false))) << "3 pixels";
    DotArea apart = work.area(false, false);
    apart.out_step = 12;
    EXPECT_FALSE(avx512::takes_quads(apart)) << "outputs are not one after the other";
    DotArea six = work.area(false, false);
    six.outputs = 6;
    EXPECT_FALSE(avx512::takes_quads(six));
    Work odd{16, 8, 8, false};
    odd.stretches[1].length = 12;
    EXPECT_FALSE(avx512::takes_quads(odd.area(false, false))) << "half of a pixel's quads";
}

TEST(Quads, PixelsAreSplitIntoMapsAndNothingIsWrittenBesideThem) {
    if (!vector_kernels().by_quads) GTEST_SKIP() << "this processor has no AVX-512";
    constexpr std::size_t kPixels = 5, kBeside = 8;
    constexpr float kMark = 7;
    for (const auto& [channels, size, maps] :
         {std::array<std::size_t, 3>{9, 4, 3}, {8, 4, 2}, {21, 8, 3}, {5, 8, 2}}) {
        const std::size_t plane = kPixels * size + kBeside;
        test::Numbers numbers{3};
        const auto in = numbers.many(kPixels * channels, Fill::ordinary);
        std::vector<float> out(maps * plane, kMark);
        avx512::split_pixels({in.data(), int(kPixels), int(channels), int(size), int(maps),
                              out.data(), std::ptrdiff_t(plane)});
        for (std::size_t map = 0; map < maps; ++map)
            for (std::size_t i = 0; i < plane; ++i) {
                const std::size_t pixel = i / size, channel = map * size + i % size;
                float expected = pixel < kPixels ? 0 : kMark;
                if (pixel < kPixels && channel < channels)
                    expected = in[pixel * channels + channel];
                ASSERT_EQ(out[map * plane + i], expected) << channels;
            }
    }
}

/// A layer whose channels lie in three maps sums them up as if they lay in one.
TEST(Quads, AMapInThreeGivesTheSameBits) {
    constexpr int kSide = 9, kChannels = 21, kPadded = 24, kOutputs = 8;
    test::Numbers numbers{3};
    plain::ConvWeights<float> weights{
        kOutputs, kPadded, {}, numbers.many(kOutputs, Fill::ordinary)};
    weights.weight = numbers.many(std::size_t(kOutputs * kPadded * 9), Fill::ordinary);
    const auto in = numbers.many(std::size_t(kSide * kSide * kChannels), Fill::ordinary);
    for (const Backend& backend : all_backends()) {
        const Numbers layer_numbers{backend};
        if (!layer_numbers.by_quads() || backend.onednn) continue;
        const int units = layer_numbers.units(8);
        const std::ptrdiff_t plane = std::ptrdiff_t(kSide) * kSide * units;
        std::vector<float> split(3 * std::size_t(plane), 5), whole(3 * std::size_t(plane));
        if (const Bf16Kernels* bf16 = layer_numbers.bf16()) {
            CompressRow row{.in = in.data(),
                            .pixels = kSide * kSide,
                            .channels = kChannels,
                            .out = split.data(),
                            .size = 8,
                            .maps = 3,
                            .plane = plane};
            bf16->compress_row(row);
            row.out = whole.data();
            row.size = kPadded;
            row.maps = 1;
            bf16->compress_row(row);
        } else {
            avx512::split_pixels({in.data(), kSide * kSide, kChannels, 8, 3, split.data(), plane});
            for (std::size_t p = 0; p < std::size_t(kSide * kSide); ++p)
                std::copy_n(in.data() + p * kChannels, kChannels, whole.data() + p * kPadded);
        }
        const auto run = [&](const PackedConv& conv, ConvArea area) {
            std::vector<float> out(49 * kOutputs), scratch(conv.scratch_size(7, 7));
            area.out = out.data();
            area.out_pitch = 7 * kOutputs;
            area.height = area.width = 7;
            conv.run(area, scratch.data());
            return out;
        };
        const float* first = split.data();
        const std::ptrdiff_t pitch = std::ptrdiff_t(kSide) * units;
        EXPECT_EQ(
            run({weights, 1, true, backend, {}, {8, 8, 8}, Summation::as_one},
                {.in = {{{first, pitch}, {first + plane, pitch}, {first + 2 * plane, pitch}}}}),
            run({weights, 1, true, backend}, {.in = {{{whole.data(), 3 * pitch}}}}))
            << name_of(backend);
    }
}

}  // namespace
}  // namespace eventide
