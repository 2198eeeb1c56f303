// Winograd's products against those of the definition, at every width and across bands of rows.
#include "src/nn/winograd_conv.h"
#include "tests/nn/fills.h"
#include "tests/nn/instruction_sets.h"

#include <cmath>
#include <limits>

namespace eventide {
namespace {

using test::Fill;

/// A layer that reads two maps, and one region of its input: rows are longer than the region, and
/// what lies beside it is NaN.
struct Layer {
    static constexpr int kFirst = 5, kSecond = 8, kOutputs = 12, kBeside = 3;
    int height, width;
    plain::ConvWeights<float> weights{kOutputs, kFirst + kSecond, {}, {}};
    std::vector<float> first, second;

    Layer(int h, int w) : height(h), width(w) {
        test::Numbers numbers{std::uint32_t(100 * h + w)};
        weights.weight = numbers.many(std::size_t(9 * kOutputs * weights.in), Fill::ordinary);
        weights.bias = numbers.many(kOutputs, Fill::ordinary);
        first = map(numbers, kFirst);
        second = map(numbers, kSecond);
    }
    int pitch() const { return width + 2 + kBeside; }
    std::vector<float> map(test::Numbers& numbers, int channels) const {
        std::vector<float> values(std::size_t((height + 2) * pitch() * channels),
                                  std::numeric_limits<float>::quiet_NaN());
        for (int y = 0; y < height + 2; ++y)
            for (int i = 0; i < (width + 2) * channels; ++i)
                values[std::size_t(y * pitch() * channels + i)] = numbers.next(Fill::ordinary);
        // The last row ends with the region: what is past it belongs to nobody.
        values.resize(values.size() - std::size_t(kBeside * channels));
        return values;
    }
    std::vector<float> run(const Backend& backend) const {
        const WinogradConv conv{weights, {kFirst, kSecond}, true, backend};
        test::Guarded out{std::size_t(height * width * kOutputs)},
            scratch{conv.scratch_size(height, width)};
        conv.run({.in = {{{first.data(), std::ptrdiff_t(pitch()) * kFirst},
                          {second.data(), std::ptrdiff_t(pitch()) * kSecond}}},
                  .out = out.data(),
                  .out_pitch = std::ptrdiff_t(width) * kOutputs,
                  .height = height,
                  .width = width},
                 scratch.data());
        EXPECT_TRUE(out.intact() && scratch.intact()) << "written outside";
        return {out.data(), out.data() + height * width * kOutputs};
    }
    /// Of output o at (y, x), by the definition in double precision.
    double exact(int y, int x, int o) const {
        double sum = weights.bias[std::size_t(o)];
        for (int c = 0; c < weights.in; ++c)
            for (int tap = 0; tap < 9; ++tap) {
                const int pixel = (y + tap / 3) * pitch() + x + tap % 3;
                sum += double(weights.weight[std::size_t((o * weights.in + c) * 9 + tap)]) *
                       (c < kFirst ? first[std::size_t(pixel * kFirst + c)]
                                   : second[std::size_t(pixel * kSecond + c - kFirst)]);
            }
        return std::max(sum, 0.0);
    }
};

TEST(WinogradConv, IsTheConvolutionAtEveryWidthAndAcrossBandsOfRows) {
    // Root of the mean square, of outputs of about 6: direct sums come to some 4e-7.
    constexpr double kMostRms = 2e-6;
    test::with_each([&](const VectorKernels& kernels) {
        for (const int height : {1, 11, 12, 13, 26})
            for (int width = 1; width <= 13; ++width) {
                const Layer layer{height, width};
                const std::vector<float> out = layer.run({&kernels});
                double squares = 0;
                for (int i = 0; const float v : out) {
                    const int pixel = i / Layer::kOutputs;
                    squares += std::pow(
                        v - layer.exact(pixel / width, pixel % width, i % Layer::kOutputs), 2);
                    ++i;
                }
                EXPECT_LT(std::sqrt(squares / double(out.size())), kMostRms)
                    << height << "x" << width;
            }
    });
}

TEST(WinogradConv, GivesTheSameBitsByAvx2AndAvx512) {
    const Layer layer{15, 22};
    EXPECT_EQ(layer.run({&vector_kernels(Instructions::avx2)}),
              layer.run({&vector_kernels(Instructions::avx512)}));
}

}  // namespace
}  // namespace eventide
