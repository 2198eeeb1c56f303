// Outlines of objects by what they cover.
#include "src/simulate/scene/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace eventide {
namespace {

struct Covered {
    double area = 0;      // of [-1, 1]^2
    double farthest = 0;  // from the middle, of what is covered
};

Covered covered_by(const Shape& shape) {
    constexpr int kSide = 200;
    constexpr double kPixel = 2.4 / kSide;  // beyond the square on all sides
    const ShapeView view{shape, {kPixel, 0, -1.2, 0, kPixel, -1.2}, 1};
    std::vector<float> row(kSide);
    Covered found;
    for (int y = 0; y < kSide; ++y) {
        view.cover(0, y, row);
        for (int x = 0; x < kSide; ++x) {
            const double share = double(row[std::size_t(x)]);
            found.area += share * kPixel * kPixel;
            if (share > .5)
                found.farthest =
                    std::max(found.farthest, std::hypot(x * kPixel - 1.2, y * kPixel - 1.2));
        }
    }
    return found;
}

TEST(Shape, DiscsRingsAndRectanglesCoverWhatTheyAreSaidTo) {
    EXPECT_NEAR(covered_by(Shape::disc()).area, std::numbers::pi, .01);
    EXPECT_NEAR(covered_by(Shape::ring(.6)).area, std::numbers::pi * (1 - .36), .01);
    EXPECT_NEAR(covered_by(Shape::rectangle()).area, 4, .01);
    EXPECT_NEAR(covered_by(Shape::rectangle()).farthest, std::numbers::sqrt2, .02);
}

TEST(Shape, CoversAPixelAlikeWhereverItsRowBegins) {
    Random random{1};
    for (const Shape& shape : {Shape::disc(), Shape::ring(.5), Shape::polygon(5, random)}) {
        const ShapeView view{shape, {.09, .02, -1.3, -.01, .1, -1.2}, 1.5};
        std::vector<float> row(28), later(24);
        for (int y = 0; y < 24; ++y) {
            view.cover(0, y, row);
            for (int begin = 1; begin <= 4; ++begin) {
                view.cover(begin, y, later);
                for (std::size_t x = 0; x < later.size(); ++x)
                    ASSERT_NEAR(later[x], row[x + std::size_t(begin)], 1e-5) << x << ',' << y;
            }
        }
    }
}

/// Corners lie on the circle, each up to .35 of the way to the next from its place in a regular
/// polygon: with angles of a between those, the mean of (corners / 2) sin(angle between two) is
/// (corners / 2) sin(a) (sin(.35 a) / (.35 a))^2.
TEST(Shape, PolygonsHaveTheirCornersAllAroundTheCircle) {
    for (const int corners : {3, 5, 8}) {
        Random random{1};
        double area = 0;
        constexpr int kShapes = 200;
        for (int i = 0; i < kShapes; ++i) {
            const Covered found = covered_by(Shape::polygon(corners, random));
            EXPECT_LT(found.farthest, 1.01);
            area += found.area / kShapes;
        }
        const double a = 2 * std::numbers::pi / corners, moved = std::sin(.35 * a) / (.35 * a);
        EXPECT_NEAR(area, corners / 2. * std::sin(a) * moved * moved, .04) << corners;
    }
}

}  // namespace
}  // namespace eventide
