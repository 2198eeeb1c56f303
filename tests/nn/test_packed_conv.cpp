// The fast convolution against the plain one and against double.
#include "src/nn/packed_conv.h"
#include "tests/nn/fills.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

using test::Fill;

template <typename T>
plain::ConvWeights<T> random_conv(int out, int in, test::Numbers& numbers) {
    plain::ConvWeights<T> weights{out, in, {}, {}};
    for (int i = 0; i < out * in * 9; ++i)
        weights.weight.push_back(T(numbers.next(Fill::ordinary)));
    for (int i = 0; i < out; ++i) weights.bias.push_back(T(numbers.next(Fill::ordinary)));
    return weights;
}

template <typename To, typename From>
plain::ConvWeights<To> as(const plain::ConvWeights<From>& from) {
    return {from.out,
            from.in,
            {from.weight.begin(), from.weight.end()},
            {from.bias.begin(), from.bias.end()}};
}

struct Shape {
    int height, width, in, out, stride;
};
const std::vector<Shape> kShapes{{1, 1, 1, 1, 1},    {1, 1, 5, 3, 2},    {7, 5, 21, 16, 1},
                                 {9, 30, 16, 32, 1}, {4, 43, 24, 24, 1}, {13, 15, 32, 17, 2},
                                 {12, 16, 9, 64, 2}, {3, 29, 33, 40, 1}, {2, 2, 64, 1, 1},
                                 {5, 35, 22, 8, 1},  {6, 9, 16, 8, 2},   {4, 1, 16, 6, 1}};

/// What rounding may do: a share of the sum of the products' sizes.
struct Bound {
    double float_share = 0, bf16_share = 0;
};
/// n products summed one after the other are each rounded at most n times; the mean is far less.
Bound bound_of(int terms) {
    return {6e-8 * std::sqrt(double(terms)) * 4, 1.0 / 128};
}

/// The largest of the outputs that are rounded together with number i.
double size_around(const Array3<double>& sizes, std::size_t i, int group) {
    const int c = int(i) % sizes.channels(), pixel = int(i) / sizes.channels();
    const int y = pixel / sizes.width(), first = pixel % sizes.width() / group * group;
    double size = 0;
    for (int x = first; x < std::min(first + group, sizes.width()); ++x)
        size = std::max(size, sizes(y, x, c));
    return size;
}

void check(const Shape& s, Fill fill, const Backend& backend) {
    test::Numbers numbers{std::uint32_t(s.height * 1000 + s.width)};
    const auto weights = random_conv<float>(s.out, s.in, numbers);
    Array3<float> in{s.height, s.width, s.in};
    for (float& v : in.values()) v = numbers.next(fill);

    Array3<double> exact_in{s.height, s.width, s.in}, sizes_in = exact_in;
    for (std::size_t i = 0; i < in.values().size(); ++i) {
        exact_in.values()[i] = in.values()[i];
        sizes_in.values()[i] = std::abs(in.values()[i]);
    }
    auto size_weights = as<double>(weights);
    for (double& v : size_weights.weight) v = std::abs(v);
    for (double& v : size_weights.bias) v = std::abs(v);
    const Array3<double> exact = plain::conv(as<double>(weights), exact_in, s.stride);
    const Array3<double> sizes = plain::conv(size_weights, sizes_in, s.stride);
    const Array3<float> plain = plain::conv(weights, in, s.stride);

    // The input with its border of zeros, and not one number more.
    const int rows = s.height + 2, columns = s.width + 2;
    std::vector<float> padded(std::size_t(rows * columns * s.in));
    for (int y = 0; y < s.height; ++y)
        std::copy_n(in.pixel(y, 0).data(), s.width * s.in,
                    padded.data() + ((y + 1) * columns + 1) * s.in);
    const PackedConv conv{weights, s.stride, false, backend, {{exact.height(), exact.width()}}};
    test::Guarded out{exact.values().size()},
        scratch{conv.scratch_size(exact.height(), exact.width())};
    conv.run({padded.data(), std::ptrdiff_t(columns) * s.in, out.data(),
              std::ptrdiff_t(exact.width()) * s.out, exact.height(), exact.width()},
             scratch.data());

    EXPECT_TRUE(out.intact()) << "written outside";
    EXPECT_TRUE(scratch.intact()) << "scratch written outside";
    const Bound bound = bound_of(9 * s.in);
    // Of a group what is rounded, positions and their weights, is larger than pixels and weights.
    const double bf16_share = bound.bf16_share * (conv.group() > 1 ? 2 : 1);
    for (std::size_t i = 0; i < exact.values().size(); ++i) {
        const double size = size_around(sizes, i, conv.group()) + 1e-37;
        ASSERT_LE(std::abs(out.data()[i] - exact.values()[i]),
                  size * (backend.bf16 != nullptr ? bf16_share : bound.float_share))
            << name_of(backend) << " " << s.height << "x" << s.width << " " << s.in << "->" << s.out
            << " fill " << int(fill);
        ASSERT_LE(std::abs(plain.values()[i] - exact.values()[i]), size * bound.float_share);
    }
}

TEST(PackedConv, AgreesWithDoubleForEveryBackendShapeAndFill) {
    for (const Backend& backend : all_backends())
        for (const Shape& shape : kShapes)
            for (const Fill fill : test::kFills) check(shape, fill, backend);
}

TEST(PackedConv, WhereATileLiesChangesNoBit) {
    // Outputs go by groups of four, the last of which may lack pixels: both have four whole ones.
    constexpr int kRow = 7, kColumn = 12, kHeight = 5, kWidth = 17, kWhole = 16, kInputs = 24;
    test::Numbers numbers{1};
    const auto weights = random_conv<float>(24, kInputs, numbers);
    const auto in = numbers.many(std::size_t(34 * 42 * kInputs), Fill::ordinary);
    for (const Backend& backend : all_backends()) {
        if (backend.onednn) continue;  // it knows its regions when it is made
        const PackedConv conv{weights, 1, true, backend};
        std::vector<float> whole(std::size_t(32 * 40 * 24)),
            part(std::size_t(kHeight * kWidth * 24));
        std::vector<float> scratch(conv.scratch_size(32, 40));
        conv.run({in.data(), 42 * kInputs, whole.data(), 40 * 24, 32, 40}, scratch.data());
        conv.run({in.data() + (kRow * 42 + kColumn) * kInputs, 42 * kInputs, part.data(),
                  kWidth * 24, kHeight, kWidth},
                 scratch.data());
        for (int y = 0; y < kHeight; ++y)
            for (int i = 0; i < kWhole * 24; ++i)
                ASSERT_EQ(part[std::size_t(y * kWidth * 24 + i)],
                          whole[std::size_t(((y + kRow) * 40 + kColumn) * 24 + i)])
                    << name_of(backend);
    }
}

TEST(UpSampling, KeepsTheSamplesOfTheStridedConvolution) {
    Array3<double> a{3, 4, 1};
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x) a(y, x, 0) = 10 * y + x;
    const Array3<double> odd = plain::up2(a, 5, 7), even = plain::up2(a, 6, 8);
    EXPECT_EQ(odd(4, 6, 0), a(2, 3, 0));
    EXPECT_EQ(odd(1, 0, 0), 5);
    EXPECT_EQ(odd(0, 1, 0), 0.5);
    EXPECT_EQ(odd(3, 5, 0), 15 + 2.5);
    EXPECT_EQ(even(5, 7, 0), a(2, 3, 0)) << "past the last sample it is repeated";
}

/// What the next layer reads: the same numbers rounded, with a zero beside the last of an odd
/// number.
TEST(PackedConv, OutputsInBf16AreThoseInFloatRounded) {
    constexpr int kHeight = 3, kWidth = 7, kInputs = 6, kRow = kWidth + 2;
    test::Numbers numbers{4};
    const auto in = numbers.many(std::size_t((kHeight + 2) * kRow * kInputs), Fill::ordinary);
    for (const Backend& backend : all_backends())
        for (const int outputs : {1, 3, 5, 6, 8, 16, 17}) {
            if (backend.bf16 == nullptr) continue;
            const PackedConv conv{random_conv<float>(outputs, kInputs, numbers),
                                  1,
                                  true,
                                  backend,
                                  {{kHeight, kWidth}}};
            const int units = conv.numbers().units(outputs);
            std::vector<float> scratch(conv.scratch_size(kHeight, kWidth)),
                wide(std::size_t(kHeight * kWidth * outputs));
            conv.run({in.data(), kRow * kInputs, wide.data(), kWidth * outputs, kHeight, kWidth},
                     scratch.data());
            std::vector<float> map(in.size());
            conv.numbers().from_float(in.data(), std::size_t((kHeight + 2) * kRow), kInputs,
                                      map.data());
            test::Guarded rounded{std::size_t(kHeight * kWidth * units)};
            conv.run(ConvArea{.in = {{{map.data(), kRow * conv.numbers().units(kInputs)}}},
                              .out = rounded.data(),
                              .out_pitch = kWidth * units,
                              .to_bf16 = true,
                              .height = kHeight,
                              .width = kWidth},
                     scratch.data());
            EXPECT_TRUE(rounded.intact());
            const auto* values = reinterpret_cast<const std::uint16_t*>(rounded.data());
            for (int pixel = 0; pixel < kHeight * kWidth; ++pixel)
                for (int o = 0; o < 2 * units; ++o)
                    ASSERT_EQ(values[2 * pixel * units + o],
                              o < outputs ? to_bf16(wide[std::size_t(pixel * outputs + o)]) : 0)
                        << name_of(backend) << ", " << outputs;
        }
}

}  // namespace
}  // namespace eventide
