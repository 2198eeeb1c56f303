// Distances to an outline in pixels, and coverage from them.
#include "src/simulate/scene/shape.h"

#include "src/core/simd4.h"

#include <algorithm>
#include <cmath>

namespace eventide {

Shape Shape::rectangle() {
    Shape shape;
    shape.sides = 4;
    shape.side = {{{1, 0, 1}, {0, 1, 1}, {-1, 0, 1}, {0, -1, 1}}};
    return shape;
}

Shape Shape::polygon(int corners, Random& random) {
    Shape shape;
    shape.sides = std::clamp(corners, 3, int(shape.side.size()));
    std::array<Point, 8> corner;
    for (int i = 0; i < shape.sides; ++i) {  // on the unit circle: convex whatever the angles
        const double angle = (i + random.uniform({-.35, .35})) * 2 * std::numbers::pi / shape.sides;
        corner[std::size_t(i)] = {std::cos(angle), std::sin(angle)};
    }
    for (int i = 0; i < shape.sides; ++i) {
        const Point a = corner[std::size_t(i)], b = corner[std::size_t((i + 1) % shape.sides)];
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        const double nx = (b.y - a.y) / length, ny = (a.x - b.x) / length;
        shape.side[std::size_t(i)] = {nx, ny, nx * a.x + ny * a.y};
    }
    return shape;
}

ShapeView::ShapeView(const Shape& shape, const Affine& to_local, double softness)
    : shape_(shape), to_local_(to_local), softness_(softness) {
    for (std::size_t i = 0; i < std::size_t(shape.sides); ++i) {
        const Shape::Side& s = shape.side[i];
        const double nx = s.nx * to_local.xx + s.ny * to_local.yx;
        const double ny = s.nx * to_local.xy + s.ny * to_local.yy;
        const double length = std::hypot(nx, ny);
        side_[i] = {nx / length, ny / length,
                    (s.distance - s.nx * to_local.x0 - s.ny * to_local.y0) / length};
    }
}

void ShapeView::cover(int x, int y, std::span<float> out) const {
    using namespace lanes;
    if (shape_.sides == 0) return cover_disc(x, y, out);
    const float inverse = float(1 / softness_);
    const F4 ramp{0, 1, 2, 3};
    for (std::size_t i = 0; i < out.size(); i += 4) {
        F4 outside = splat(-1e9f);  // distance beyond the side that is nearest to being crossed
        for (std::size_t s = 0; s < std::size_t(shape_.sides); ++s) {
            const Shape::Side& side = side_[s];
            const double start = side.nx * (x + double(i)) + side.ny * y - side.distance;
            outside = max(outside, splat(float(start)) + ramp * float(side.nx));
        }
        store(out.data() + i, clamp(.5f - outside * inverse, 0, 1));
    }
}

/// Near the circle the distance is (r^2 - 1) over the length of r^2's gradient.
void ShapeView::cover_disc(int x, int y, std::span<float> out) const {
    using namespace lanes;
    const float hole2 = float(shape_.hole * shape_.hole), inverse = float(1 / softness_);
    const auto xx = float(to_local_.xx), xy = float(to_local_.xy);
    const auto yx = float(to_local_.yx), yy = float(to_local_.yy);
    const Point start = to_local_({double(x), double(y)});
    const F4 ramp{0, 1, 2, 3};
    for (std::size_t i = 0; i < out.size(); i += 4) {
        const F4 column = ramp + float(i);
        const F4 u = float(start.x) + column * xx, v = float(start.y) + column * yx;
        const F4 r2 = u * u + v * v;
        const F4 gx = u * xx + v * yx, gy = u * xy + v * yy;
        const F4 per_gradient = .5f * inverse_sqrt(gx * gx + gy * gy + 1e-12f);
        F4 outside = (r2 - 1.f) * per_gradient;
        if (hole2 > 0) outside = max(outside, (hole2 - r2) * per_gradient);
        store(out.data() + i, clamp(.5f - outside * inverse, 0, 1));
    }
}

}  // namespace eventide
