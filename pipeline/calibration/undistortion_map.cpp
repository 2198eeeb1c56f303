// Lens models, from the ray to the pixel.
#include "pipeline/calibration/undistortion_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace eventide {

namespace {

struct Point {
    double x, y;
};

/// A ray through (x, y) at distance 1, where the lens shows it on that plane.
class Lens {
public:
    explicit Lens(const Calibration& calibration)
        : fisheye_{calibration.distortion_model == "equidistant"} {
        std::copy_n(calibration.d.begin(), std::min(calibration.d.size(), d_.size()), d_.begin());
        turns_back_ = first_turn();
    }

    bool shows(const Point& ray) const { return std::hypot(ray.x, ray.y) < turns_back_; }

    Point distorted(const Point& ray) const {
        const double r2 = ray.x * ray.x + ray.y * ray.y;
        if (fisheye_) {
            const double r = std::sqrt(r2);
            const double scale = r > 0 ? radius(r) / r : 1.0;
            return {ray.x * scale, ray.y * scale};
        }
        const double scale = polynomial(r2), xy = ray.x * ray.y;
        // Tangential: d[2] is p1, d[3] is p2.
        return {ray.x * scale + 2 * d_[2] * xy + d_[3] * (r2 + 2 * ray.x * ray.x),
                ray.y * scale + d_[2] * (r2 + 2 * ray.y * ray.y) + 2 * d_[3] * xy};
    }

private:
    /// k1 k2 p1 p2 k3 k4 k5 k6: (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6).
    double polynomial(double r2) const {
        return (1 + r2 * (d_[0] + r2 * (d_[1] + r2 * d_[4]))) /
               (1 + r2 * (d_[5] + r2 * (d_[6] + r2 * d_[7])));
    }

    /// How far from the middle a ray at `r` from it is shown, without the tangential part.
    double radius(double r) const {
        if (!fisheye_) return r * polynomial(r * r);
        const double theta = std::atan(r), t2 = theta * theta;
        return theta * (1 + t2 * (d_[0] + t2 * (d_[1] + t2 * (d_[2] + t2 * d_[3]))));
    }

    /// The smallest r from which on radius() falls, to a thousandth; 170 degrees of view are looked
    /// at.
    double first_turn() const {
        constexpr double kStep = 1e-3;
        constexpr int kSteps = 11'400;
        for (int i = 0; i < kSteps; ++i)
            if (const double r = i * kStep; !(radius(r + kStep) > radius(r))) return r;
        return std::numeric_limits<double>::infinity();
    }

    bool fisheye_;
    std::array<double, 8> d_{};
    double turns_back_;
};

/// 3x3, row by row.
std::array<double, 9> inverse(const std::array<double, 9>& m) {
    const double a = m[4] * m[8] - m[5] * m[7], b = m[5] * m[6] - m[3] * m[8],
                 c = m[3] * m[7] - m[4] * m[6];
    const double det = m[0] * a + m[1] * b + m[2] * c;
    std::array<double, 9> inverse{a, m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
                                  b, m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
                                  c, m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
    for (double& v : inverse) v /= det;
    return inverse;
}

std::array<double, 9> product(const std::array<double, 9>& a, const std::array<double, 9>& b) {
    std::array<double, 9> c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    return c;
}

std::array<double, 9> new_camera(const Calibration& calibration) {
    const auto& p = calibration.p;
    return {p[0], p[1], p[2], p[4], p[5], p[6], p[8], p[9], p[10]};
}

}  // namespace

Calibration undistorted(const Calibration& calibration) {
    Calibration flat = calibration;
    flat.distortion_model = "plumb_bob";
    flat.d.assign(5, 0.0);
    flat.k = new_camera(calibration);
    flat.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    return flat;
}

SourcePlaces source_places(const Calibration& calibration, const Region& region) {
    const Lens lens{calibration};
    // Pixel -> ray of the new camera -> ray of the camera as it stands.
    const auto to_ray = inverse(product(new_camera(calibration), calibration.r));
    SourcePlaces places{Array2<float>{region.height, region.width},
                        Array2<float>{region.height, region.width}};
    for (int y = 0; y < region.height; ++y)
        for (int x = 0; x < region.width; ++x) {
            const double u = region.x + x, v = region.y + y;
            const double w = to_ray[6] * u + to_ray[7] * v + to_ray[8];
            const Point ray{(to_ray[0] * u + to_ray[1] * v + to_ray[2]) / w,
                            (to_ray[3] * u + to_ray[4] * v + to_ray[5]) / w};
            places.x(y, x) = places.y(y, x) = SourcePlaces::kNowhere;
            if (!(w > 0) || !lens.shows(ray)) continue;
            const Point shown = lens.distorted(ray);
            const double px =
                calibration.k[0] * shown.x + calibration.k[1] * shown.y + calibration.k[2];
            const double py = calibration.k[4] * shown.y + calibration.k[5];
            if (!(std::abs(px) < 1e5 && std::abs(py) < 1e5)) continue;
            places.x(y, x) = float(px);
            places.y(y, x) = float(py);
        }
    return places;
}

Region region_of(const SourcePlaces& places, int width, int height, int margin) {
    float left = float(width), top = float(height), right = -1, bottom = -1;
    const auto xs = places.x.values(), ys = places.y.values();
    for (std::size_t i = 0; i < xs.size(); ++i) {
        if (xs[i] < -0.5f || ys[i] < -0.5f || xs[i] > float(width) - 0.5f ||
            ys[i] > float(height) - 0.5f)
            continue;
        left = std::min(left, xs[i]);
        right = std::max(right, xs[i]);
        top = std::min(top, ys[i]);
        bottom = std::max(bottom, ys[i]);
    }
    if (right < left || bottom < top) return {};
    const int x0 = std::max(0, int(std::floor(left)) - margin);
    const int y0 = std::max(0, int(std::floor(top)) - margin);
    const int x1 = std::min(width, int(std::ceil(right)) + 1 + margin);
    const int y1 = std::min(height, int(std::ceil(bottom)) + 1 + margin);
    return {x0, y0, x1 - x0, y1 - y0};
}

}  // namespace eventide
