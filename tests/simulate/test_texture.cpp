// Looking textures up: interpolation, mirrors, sizes, and the lanes under it.
#include "src/core/error.h"
#include "src/core/simd4.h"
#include "src/simulate/scene/shape.h"
#include "src/simulate/scene/textures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

std::vector<float> look(const Texture& texture, const Affine& map, int n, float detail = 0) {
    std::vector<float> out(static_cast<std::size_t>(n));
    texture.sample(Texture::walk(map, 0, 0), detail, out);
    return out;
}

GreyImage ramp(int height, int width) {
    GreyImage image(height, width);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image(y, x) = std::uint8_t(255 * x / (width - 1));
    return image;
}

TEST(Lanes, ExpAndLogAreTheMathLibrarysWithinTheirPromise) {
    for (double x = -40; x < 40; x += .0137) {
        const float e = lanes::exp(lanes::splat(float(x)))[0];
        ASSERT_NEAR(e / std::exp(double(float(x))), 1, 3e-6) << x;
        const float l = lanes::log(lanes::splat(float(std::exp(x))))[1];
        ASSERT_NEAR(l, std::log(double(float(std::exp(x)))), 3e-7 * std::max(1.0, std::abs(x)));
    }
}

TEST(Texture, StretchesGreyValuesToTheWholeRange) {
    GreyImage image(16, 16);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) image(y, x) = x < 8 ? 100 : 120;
    const auto row = look(Texture{image}, {1. / 16, 0, .5 / 16, 0, 0, .5}, 16);
    EXPECT_NEAR(row[2], 0, 1e-4);
    EXPECT_NEAR(row[12], 1, 1e-4);
}

TEST(Texture, IsLinearBetweenTexelCentres) {
    const Texture texture{ramp(64, 64)};
    // Centres of texels 0 and 63 are at .5/64 and 63.5/64.
    const auto row = look(texture, {63. / 64 / 99, 0, .5 / 64, 0, 0, .3}, 100);
    for (int i = 0; i < 100; ++i) EXPECT_NEAR(row[std::size_t(i)], i / 99., .004);
}

TEST(Texture, GoesOnMirroredWithoutEnd) {
    const Texture texture{procedural_image(2, 64, 5)};
    const double step = 1 / 40.0;
    const auto inside = look(texture, {step, .0, .013, 0, 0, .4}, 40);
    for (const double turns : {2.0, -2.0, 4000.0}) {
        const auto again = look(texture, {step, 0, .013 + turns, 0, 0, .4}, 40);
        for (std::size_t i = 0; i < 40; ++i) EXPECT_NEAR(again[i], inside[i], 1e-4);
    }
    const auto back = look(texture, {-step, 0, 2 - .013, 0, 0, 2 - .4}, 40);
    for (std::size_t i = 0; i < 40; ++i) EXPECT_NEAR(back[i], inside[i], 1e-4);
}

TEST(Texture, ShowsStripesWherePixelsAreAsFineAsTheyAreAndGreyWhereTheyAreCoarser) {
    GreyImage stripes(64, 64);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) stripes(y, x) = x % 2 == 0 ? 0 : 255;
    const Texture texture{stripes};
    const auto contrast = [&](double texels_a_pixel) {
        const double step = texels_a_pixel / 64;
        const Affine map{step, 0, 16.5 / 64, 0, step, .5};  // far from the mirrors
        const auto row = look(texture, map, 8, texture.detail(map));
        return *std::ranges::max_element(row) - *std::ranges::min_element(row);
    };
    EXPECT_NEAR(contrast(1), 1, 1e-3);
    EXPECT_LT(contrast(3), .05) << "3 would show every third stripe";
}

TEST(Texture, KeepsItsMeanAtEveryLevelOfDetail) {
    const Texture texture{procedural_image(0, 128, 1)};
    const auto mean = [&](float detail) {
        double sum = 0;
        for (int j = 0; j < 64; ++j)
            for (const float v :
                 look(texture, {1 / 64., 0, .5 / 64, 0, 0, (j + .5) / 64}, 64, detail))
                sum += double(v) / 4096;
        return sum;
    };
    for (const float detail : {0.f, 1.f, 2.5f, 5.f, 7.f}) EXPECT_NEAR(mean(detail), mean(0), .01);
}

TEST(Texture, DetailGrowsByOneWhenEverythingIsHalfTheSize) {
    const Texture texture{ramp(128, 128)};
    const auto detail = [&](double texels) {
        return texture.detail({texels / 128, 0, 0, 0, texels / 128, 0});
    };
    EXPECT_NEAR(detail(8) - detail(4), 1, 1e-5);
    EXPECT_EQ(detail(.5), 0);
    EXPECT_EQ(detail(1e6), 7);
}

TEST(Texture, RefusesAnImageThatIsALine) {
    EXPECT_THROW(Texture{GreyImage(1, 50)}, Error);
}

TEST(Shape, CoversItsAreaAtAnySizeAndPlace) {
    Random random{4};
    const double area_of_disc = std::numbers::pi;
    struct Case {
        Shape shape;
        double area;  // in its own plane
    };
    for (const Case& c : {Case{Shape::disc(), area_of_disc}, Case{Shape::rectangle(), 4},
                          Case{Shape::ring(.5), area_of_disc * .75}})
        for (int i = 0; i < 20; ++i) {
            const double a = random.uniform({8, 25}), b = random.uniform({8, 25});
            const Affine to_local = Affine::translation(40 + random.uniform(), 41)
                                        .after(Affine::rotation(random.uniform({0, 6})))
                                        .after(Affine::scale(a, b))
                                        .inverse();
            const ShapeView view{c.shape, to_local, 1};
            double sum = 0;
            std::vector<float> row(80);
            for (int y = 0; y < 82; ++y) {
                view.cover(0, y, row);
                for (const float v : row) sum += double(v);
            }
            EXPECT_NEAR(sum / (c.area * a * b), 1, .03);
        }
}

TEST(Shape, ARingIsAsSoftAtItsHoleAsAtItsRim) {
    const double radius = 100, softness = 12;
    const Shape ring = Shape::ring(.5);
    const ShapeView view{ring, Affine::scale(1 / radius, 1 / radius), softness};
    std::vector<float> row(112);  // from the middle outwards
    view.cover(0, 0, row);
    for (int d = -5; d <= 5; ++d) {
        EXPECT_NEAR(row[std::size_t(50 + d)], .5 + d / softness, .03) << d;
        EXPECT_NEAR(row[std::size_t(100 + d)], .5 - d / softness, .03) << d;
    }
}

TEST(Shape, NoTwoPolygonsAreAlike) {
    Random random{7};
    const Shape a = Shape::polygon(5, random), b = Shape::polygon(5, random);
    EXPECT_GT(std::abs(a.side[0].nx - b.side[0].nx), .01);
}

TEST(Shape, PolygonsTouchTheUnitCircleFromWithin) {
    Random random{9};
    for (int corners = 3; corners <= 8; ++corners) {
        const Shape shape = Shape::polygon(corners, random);
        ASSERT_EQ(shape.sides, corners);
        for (int i = 0; i < corners; ++i) {
            EXPECT_GT(shape.side[std::size_t(i)].distance, -.2);
            EXPECT_LT(shape.side[std::size_t(i)].distance, 1);
        }
    }
}

}  // namespace
}  // namespace eventide
