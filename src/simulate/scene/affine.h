// Affine maps of the plane, and how far they move things.
#pragma once

#include <cmath>

namespace eventide {

struct Point {
    double x = 0, y = 0;
};

/// (x, y) -> (xx x + xy y + x0, yx x + yy y + y0)
struct Affine {
    double xx = 1, xy = 0, x0 = 0;
    double yx = 0, yy = 1, y0 = 0;

    Point operator()(Point p) const { return {xx * p.x + xy * p.y + x0, yx * p.x + yy * p.y + y0}; }
    double determinant() const { return xx * yy - xy * yx; }
    Affine inverse() const {
        const double d = 1 / determinant();
        return {yy * d, -xy * d, (xy * y0 - yy * x0) * d, -yx * d, xx * d, (yx * x0 - xx * y0) * d};
    }
    /// First `inner`, then this.
    Affine after(const Affine& inner) const {
        const Point origin = (*this)(Point{inner.x0, inner.y0});
        return {xx * inner.xx + xy * inner.yx, xx * inner.xy + xy * inner.yy, origin.x,
                yx * inner.xx + yy * inner.yx, yx * inner.xy + yy * inner.yy, origin.y};
    }

    static Affine translation(double x, double y) { return {1, 0, x, 0, 1, y}; }
    static Affine scale(double x, double y) { return {x, 0, 0, 0, y, 0}; }
    static Affine rotation(double angle) {
        const double c = std::cos(angle), s = std::sin(angle);
        return {c, -s, 0, s, c, 0};
    }
};

}  // namespace eventide
