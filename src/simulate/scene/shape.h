// Outlines of objects, and how much of a pixel they cover.
#pragma once

#include "src/simulate/random.h"
#include "src/simulate/scene/affine.h"

#include <array>
#include <span>

namespace eventide {

/// Within [-1, 1]^2: its circle as a disc, a ring (a disc with a hole) or a convex polygon with its
/// corners on that, or all of it, a rectangle.
struct Shape {
    struct Side {
        double nx = 0, ny = 0, distance = 0;  ///< inside: nx x + ny y < distance
    };
    int sides = 0;  ///< 0: disc or ring
    std::array<Side, 8> side;
    double hole = 0;  ///< radius; 0: none

    static Shape disc() { return {}; }
    static Shape ring(double hole) { return {.sides = 0, .side = {}, .hole = hole}; }
    static Shape rectangle();
    static Shape polygon(int corners, Random& random);
};

/// A shape put before a camera: how much of each output pixel it covers.
class ShapeView {
public:
    /// `to_local`: output pixel -> [-1, 1]^2. `softness`: width of the edge in output pixels.
    ShapeView(const Shape& shape, const Affine& to_local, double softness);

    /// out[i] = share of pixel (x + i, y) that is covered, 0 to 1. out.size() is a multiple of 4.
    void cover(int x, int y, std::span<float> out) const;

private:
    void cover_disc(int x, int y, std::span<float> out) const;

    const Shape& shape_;
    Affine to_local_;
    double softness_;
    std::array<Shape::Side, 8> side_;  // in output pixels
};

}  // namespace eventide
