// Winograd's products against those of the definition, at every width and across bands of rows.
#include "src/nn/packed_conv.h"
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
    static constexpr int kFirst = 6, kSecond = 8, kOutputs = 12, kBeside = 3;
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
    /// What comes out, in float32; `to_bf16`: rounded to what layers read.
    std::vector<float> run(const Backend& backend, bool to_bf16 = false) const {
        return run(WinogradConv{weights, {kFirst, kSecond}, true, backend}, backend, to_bf16);
    }
    /// By the definition's products.
    std::vector<float> run_direct(const Backend& backend) const {
        const PackedConv conv{
            weights, 1, true, backend, {}, {kFirst, kSecond}, Summation::by_pixel};
        return run(conv, backend, false);
    }
    template <typename Conv>
    std::vector<float> run(const Conv& conv, const Backend& backend, bool to_bf16) const {
        const Numbers numbers{backend};
        const std::vector<float> a = as_read(numbers, first, kFirst),
                                 b = as_read(numbers, second, kSecond);
        const int units = to_bf16 ? numbers.units(kOutputs) : kOutputs;
        test::Guarded out{std::size_t(height * width * units)},
            scratch{conv.scratch_size(height, width)};
        conv.run({.in = {{{a.data(), std::ptrdiff_t(pitch()) * numbers.units(kFirst)},
                          {b.data(), std::ptrdiff_t(pitch()) * numbers.units(kSecond)}}},
                  .out = out.data(),
                  .out_pitch = std::ptrdiff_t(width) * units,
                  .to_bf16 = to_bf16,
                  .height = height,
                  .width = width},
                 scratch.data());
        EXPECT_TRUE(out.intact() && scratch.intact()) << "written outside";
        std::vector<float> values(out.data(), out.data() + height * width * units);
        if (!to_bf16) return values;
        std::vector<float> wide(std::size_t(height * width * kOutputs));
        numbers.to_float(values.data(), std::size_t(height * width), kOutputs, wide.data());
        return wide;
    }
    static std::vector<float> as_read(const Numbers& numbers, const std::vector<float>& map,
                                      int channels) {
        const std::size_t pixels = map.size() / std::size_t(channels);
        std::vector<float> read(pixels * std::size_t(numbers.units(channels)));
        numbers.from_float(map.data(), pixels, channels, read.data());
        return read;
    }
    /// Root of the mean squared error, of outputs of about 6.
    double error_of(const std::vector<float>& out) const {
        double squares = 0;
        for (int i = 0; const float v : out) {
            const int pixel = i / kOutputs;
            squares += std::pow(v - exact(pixel / width, pixel % width, i % kOutputs), 2);
            ++i;
        }
        return std::sqrt(squares / double(out.size()));
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

/// body(layer) of every width, of one band of rows and of several.
template <typename Body>
void with_layers(const Body& body) {
    for (const int height : {1, 11, 12, 13, 26})
        for (int width = 1; width <= 13; ++width) {
            SCOPED_TRACE(std::to_string(height) + "x" + std::to_string(width));
            body(Layer{height, width});
        }
}

TEST(WinogradConv, IsTheConvolutionAtEveryWidthAndAcrossBandsOfRows) {
    constexpr double kMostRms = 2e-6;  // direct sums come to some 4e-7
    test::with_each([&](const VectorKernels& kernels) {
        with_layers([&](const Layer& layer) {
            EXPECT_LT(layer.error_of(layer.run({&kernels})), kMostRms);
        });
    });
}

TEST(WinogradConv, GivesTheSameBitsByAvx2AndAvx512) {
    const Layer layer{15, 22};
    EXPECT_EQ(layer.run({&vector_kernels(Instructions::avx2)}),
              layer.run({&vector_kernels(Instructions::avx512)}));
}

std::vector<const Bf16Kernels*> bf16_kernels_with_sums() {
    std::vector<const Bf16Kernels*> found;
    for (const Bf16Kernels* kernels : test::all_bf16_kernels())
        if (kernels->winograd_input != nullptr) found.push_back(kernels);
    return found;
}

TEST(WinogradConv, InBf16IsTheConvolutionWithinItsRounding) {
    constexpr double kMostTimes = 4;  // what direct products in bf16 come to
    for (const Bf16Kernels* kernels : bf16_kernels_with_sums())
        with_layers([&](const Layer& layer) {
            const std::vector<float> out = layer.run({.bf16 = kernels}),
                                     rounded = layer.run({.bf16 = kernels}, true);
            EXPECT_LT(layer.error_of(out),
                      kMostTimes * layer.error_of(layer.run_direct({.bf16 = kernels})));
            for (std::size_t i = 0; i < out.size(); ++i)
                ASSERT_EQ(rounded[i], from_bf16(to_bf16(out[i])));
        });
}

TEST(WinogradConv, PositionsOfBf16AreThoseOfFloat32RoundedOnce) {
    test::Numbers random{7};
    for (const Bf16Kernels* kernels : bf16_kernels_with_sums())
        for (const int channels : {2, 8, 14, 16, 18, 32, 48})
            for (int pixels = 3; pixels <= 12; ++pixels) {
                constexpr int kRows = 4;
                const int groups = (pixels - 3) / kWinogradOutputs + 1;
                const std::size_t read = std::size_t(kRows * pixels * channels),
                                  plane = std::size_t(groups * kRows * channels),
                                  written = kWinogradPositions * plane;
                std::vector<float> in = random.many(read, Fill::mixed);
                std::vector<std::uint16_t> narrow(read);
                for (std::size_t i = 0; i < read; ++i)
                    in[i] = from_bf16(narrow[i] = to_bf16(in[i]));
                std::vector<float> positions(written);
                test::Guarded out{written / 2};
                WinogradInput input{.in = in.data(),
                                    .pitch = std::ptrdiff_t(pixels) * channels,
                                    .rows = kRows,
                                    .pixels = pixels,
                                    .channels = channels,
                                    .out = positions.data(),
                                    .plane = std::ptrdiff_t(plane),
                                    .step = channels};
                vector_kernels(Instructions::avx2).winograd_input(input);
                input.in = narrow.data();
                input.out = out.data();
                input.pitch /= 2;
                input.plane /= 2;
                input.step /= 2;
                kernels->winograd_input(input);
                ASSERT_TRUE(out.intact());
                const auto* rounded = reinterpret_cast<const std::uint16_t*>(out.data());
                for (std::size_t i = 0; i < written; ++i)
                    ASSERT_EQ(rounded[i], to_bf16(positions[i]))
                        << channels << " channels, " << pixels << " pixels, number " << i;
            }
}

}  // namespace
}  // namespace eventide
