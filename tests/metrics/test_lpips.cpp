// LPIPS against the distances its authors' code gives, and the npz reader beneath it.
#include "src/core/error.h"
#include "src/io/npz.h"
#include "src/metrics/convolution.h"
#include "src/metrics/lpips.h"
#include "tests/io/npz_writer.h"
#include "tests/metrics/images.h"
#include "tests/support/error_of.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

namespace eventide {
namespace {

namespace fs = std::filesystem;

Array3<float> read_colour(const fs::path& path) {
    const cv::Mat image = cv::imread(path.string(), cv::IMREAD_COLOR);
    Array3<float> out(image.rows, image.cols, 3);
    for (int y = 0; y < image.rows; ++y)
        for (int x = 0; x < image.cols; ++x)
            for (int c = 0; c < 3; ++c)
                out(y, x, c) = float(image.at<cv::Vec3b>(y, x)[2 - c]) / 255;
    return out;
}

class LpipsSqueeze : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(folder_ / "lpips_squeeze_v0.1.npz"))
            GTEST_SKIP() << "no LPIPS weights: " << folder_ << " is absent";
        lpips_.emplace(folder_ / "lpips_squeeze_v0.1.npz");
    }
    fs::path folder_ = shared_data() / "perceptual";
    std::optional<Lpips> lpips_;
};

TEST_F(LpipsSqueeze, GivesTheGoldenDistances) {
    const auto reference = lpips_->features(read_colour(folder_ / "ex_ref.png"));
    const auto p0 = lpips_->features(read_colour(folder_ / "ex_p0.png"));
    const auto p1 = lpips_->features(read_colour(folder_ / "ex_p1.png"));
    EXPECT_NEAR(lpips_->distance(reference, p0), .7110, 1e-4);
    EXPECT_NEAR(lpips_->distance(reference, p1), .1479, 1e-4);
    EXPECT_EQ(lpips_->name(), "LPIPS-Squeeze");
}

TEST_F(LpipsSqueeze, FindsNothingBetweenAnImageAndItself) {
    const auto features = lpips_->features(test_image(60, 80, 1));
    EXPECT_EQ(lpips_->distance(features, features), 0);
}

TEST_F(LpipsSqueeze, IsSymmetricAndGrowsWithNoise) {
    const auto clean = test_image(60, 80, 1), other = test_image(60, 80, 2);
    const auto mixed = [&](float share) {
        auto out = clean;
        for (std::size_t i = 0; i < out.values().size(); ++i)
            out.values()[i] += share * (other.values()[i] - out.values()[i]);
        return lpips_->features(out);
    };
    const auto reference = lpips_->features(clean);
    const auto near = mixed(.1F), far = mixed(.6F);
    EXPECT_LT(lpips_->distance(reference, near), lpips_->distance(reference, far));
    EXPECT_DOUBLE_EQ(lpips_->distance(far, reference), lpips_->distance(reference, far));
}

TEST_F(LpipsSqueeze, PutsTheDistanceWhereTheImagesDiffer) {
    const auto a = test_image(96, 96, 1);
    auto b = a;
    for (int y = 32; y < 48; ++y)
        for (int x = 64; x < 80; ++x) b(y, x) = 1 - b(y, x);
    const auto map = lpips_->distance_map(lpips_->features(a), lpips_->features(b));
    EXPECT_GT(map(40, 72), 5 * map(85, 8));
}

/// 65 px: 32 after the first convolution, of which pools take the window over the edge, too.
TEST_F(LpipsSqueeze, PoolsRoundUpAsTorchvisionsDo) {
    const auto features = lpips_->features(test_image(65, 65, 1));
    ASSERT_EQ(features.layers.size(), 7U);
    const int expected[] = {32, 16, 8, 4, 4, 4, 4};
    for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(features.layers[i].height(), expected[i]) << i;
}

TEST_F(LpipsSqueeze, RefusesAnImageTooSmallForItsPools) {
    EXPECT_NO_THROW(lpips_->features(test_image(17, 17, 1)));
    EXPECT_THROW(lpips_->features(test_image(16, 64, 1)), Error);
    EXPECT_THROW(lpips_->features(test_image(64, 16, 1)), Error);
}

TEST_F(LpipsSqueeze, RefusesImagesOfTwoSizes) {
    const auto features = lpips_->features(test_image(40, 40, 1));
    for (const auto& other : {test_image(40, 44, 1), test_image(44, 40, 1)})
        EXPECT_EQ(test::error_of([&] { lpips_->distance(features, lpips_->features(other)); }),
                  "LPIPS-Squeeze: expected two images of the same size, found 40x40 and " +
                      std::to_string(other.width()) + "x" + std::to_string(other.height()));
}

/// A difference at one of 15 x 15 places of the first layer alone, brought to 64 x 64 px: centres
/// of places lie 64 / 15 px apart, the outermost as far from the edges as from halfway to the next.
void expect_bilinear_map(const Lpips& lpips, const Lpips::Features& like) {
    Lpips::Features none = like;
    for (Array3<float>& layer : none.layers) std::ranges::fill(layer.values(), 0.F);
    const auto map_of = [&](int place) {
        Lpips::Features one = none;
        one.layers[0](place, place, 3) = 1;
        return lpips.distance_map(one, none);
    };
    const Array2<float> first = map_of(0), last = map_of(14), middle = map_of(7);
    const float whole = first(0, 0);
    EXPECT_GT(whole, 0);
    for (int i = 0; i < 64; ++i) {
        const double at = (i + .5) * 15 / 64 - .5;
        const auto share = [&](int place) {
            return std::max(0., 1 - std::abs(std::clamp(at, 0., 14.) - place));
        };
        EXPECT_NEAR(first(i, 0), double(whole) * share(0), 1e-6) << i;
        EXPECT_NEAR(last(63, i), double(whole) * share(14), 1e-6) << i;
        EXPECT_NEAR(middle(31, i), double(whole) * share(7) * (1 - .5 * 15 / 64), 1e-6) << i;
    }
}

/// A network of the Alex layout with random weights: the file format is what is tested.
TEST(LpipsAlex, IsReadFromTheSameLayout) {
    const fs::path path = fs::path{testing::TempDir()} / "alex.npz";
    NpzWriter writer;
    std::mt19937 random{1};
    std::uniform_real_distribution<float> uniform{-.1F, .1F};
    const auto add = [&](const std::string& name, std::vector<std::int64_t> shape, float shift) {
        std::size_t n = 1;
        for (const auto s : shape) n *= std::size_t(s);
        std::vector<float> values(n);
        for (float& v : values) v = uniform(random) + shift;
        writer.add(name, shape, values, n % 2 == 0);
    };
    struct Layer {
        const char* name;
        std::int64_t out, in, kernel;
    };
    int index = 0;
    for (const Layer& l : {Layer{"slice1.0", 64, 3, 11}, Layer{"slice2.3", 192, 64, 5},
                           Layer{"slice3.6", 384, 192, 3}, Layer{"slice4.8", 256, 384, 3},
                           Layer{"slice5.10", 256, 256, 3}}) {
        add(std::string("core.net.") + l.name + ".weight", {l.out, l.in, l.kernel, l.kernel}, 0);
        add(std::string("core.net.") + l.name + ".bias", {l.out}, 0);
        add("core.lins." + std::to_string(index++) + ".model.1.weight", {1, l.out, 1, 1}, .2F);
    }
    add("core.scaling_layer.shift", {1, 3, 1, 1}, 0);
    add("core.scaling_layer.scale", {1, 3, 1, 1}, .5F);
    writer.write(path);

    const Lpips lpips{path};
    EXPECT_EQ(lpips.name(), "LPIPS-Alex");
    const auto a = lpips.features(test_image(64, 64, 1)), b = lpips.features(test_image(64, 64, 2));
    ASSERT_EQ(a.layers.size(), 5U);
    EXPECT_EQ(a.layers[0].height(), 15);  // (64 + 4 - 11) / 4 + 1
    EXPECT_EQ(a.layers[1].height(), 7);
    EXPECT_EQ(a.layers[2].height(), 3);
    EXPECT_EQ(lpips.distance(a, a), 0);
    EXPECT_GT(lpips.distance(a, b), 0);
    EXPECT_NO_THROW(lpips.features(test_image(31, 31, 1)));
    EXPECT_THROW(lpips.features(test_image(30, 31, 1)), Error);
    EXPECT_THROW(lpips.features(test_image(31, 30, 1)), Error);
    EXPECT_THROW(lpips.features(Array3<float>(64, 64, 1)), Error) << "of one channel";
    expect_bilinear_map(lpips, a);
}

/// The definition, one output at a time.
TEST(Convolution, IsTheSumOverItsNeighbourhood) {
    const fs::path path = fs::path{testing::TempDir()} / "convolution.npz";
    std::mt19937 random{3};
    std::uniform_real_distribution<float> uniform{-1, 1};
    const auto drawn = [&](std::size_t n) {
        std::vector<float> values(n);
        for (float& v : values) v = uniform(random);
        return values;
    };
    for (const ConvolutionShape& shape :
         {ConvolutionShape{5, 7, 3, 1, 1}, ConvolutionShape{3, 4, 3, 2, 0},
          ConvolutionShape{6, 2, 1, 1, 0}, ConvolutionShape{2, 3, 5, 1, 2},
          ConvolutionShape{3, 2, 11, 4, 2}}) {
        const int k = shape.kernel;
        const auto weights = drawn(std::size_t(shape.out * shape.in * k * k));
        const auto bias = drawn(std::size_t(shape.out));
        NpzWriter writer;
        writer.add("c.weight", {shape.out, shape.in, k, k}, weights, false);
        writer.add("c.bias", {shape.out}, bias, false);
        writer.write(path);
        const Convolution convolution{NpzFile{path}, "c", shape};
        FeatureMap in(23, 31, shape.in);
        std::ranges::copy(drawn(in.values().size()), in.values().begin());
        FeatureMap out(convolution.output_size(23), convolution.output_size(31), shape.out);
        convolution.process(in, out);
        for (int y = 0; y < out.height(); ++y)
            for (int x = 0; x < out.width(); ++x)
                for (int o = 0; o < shape.out; ++o) {
                    double sum = double(bias[std::size_t(o)]);
                    for (int i = 0; i < shape.in; ++i)
                        for (int ky = 0; ky < k; ++ky)
                            for (int kx = 0; kx < k; ++kx) {
                                const int yy = y * shape.stride + ky - shape.padding;
                                const int xx = x * shape.stride + kx - shape.padding;
                                if (yy < 0 || yy >= 23 || xx < 0 || xx >= 31) continue;
                                const int at = ((o * shape.in + i) * k + ky) * k + kx;
                                sum += double(weights[std::size_t(at)]) * double(in(yy, xx, i));
                            }
                    ASSERT_NEAR(out(y, x, o), std::max(0., sum), 1e-4);
                }
    }
}

TEST(Convolution, RefusesWeightsOfAnotherShape) {
    const fs::path path = fs::path{testing::TempDir()} / "other_shape.npz";
    NpzWriter writer;
    writer.add("c.weight", {2, 3, 1, 1}, std::vector<float>(6), false);
    writer.add("c.bias", {2}, std::vector<float>(2), false);
    writer.write(path);
    const NpzFile file{path};
    EXPECT_NO_THROW((Convolution{file, "c", {.in = 3, .out = 2}}));
    EXPECT_EQ(
        test::error_of([&] { Convolution(file, "c", {.in = 2, .out = 2}); }, ErrorKind::input),
        path.string() + ": array 'c.weight': expected shape [2, 2, 1, 1], found [2, 3, 1, 1]");
    EXPECT_EQ(
        test::error_of([&] { Convolution(file, "c", {.in = 3, .out = 1}); }, ErrorKind::input),
        path.string() + ": array 'c.bias': expected shape [1], found [2]");
}

TEST(MaxPool, TakesAWindowOverTheEdgeOnlyWhenItRoundsUp) {
    FeatureMap in(6, 7, 1);
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 7; ++x) in(y, x, 0) = float(10 * y + x);
    const FeatureMap down = max_pool(in, false), up = max_pool(in, true);
    EXPECT_EQ(down.height(), 2);
    EXPECT_EQ(down.width(), 3);
    EXPECT_EQ(down(1, 2, 0), 46);
    EXPECT_EQ(up.height(), 3);
    EXPECT_EQ(up.width(), 3);
    EXPECT_EQ(up(2, 0, 0), 52);
}

}  // namespace
}  // namespace eventide
