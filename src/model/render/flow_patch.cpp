// A patch of a frame that looks for its place in another one.
#include "src/model/render/flow_patch.h"

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

constexpr int kMaxSteps = 12;
// A patch that ends further than this from where it began has lost its way.
constexpr float kFurthest = 8;
// Added to the squares of gradients, so that noise on plain surfaces does not move a patch.
constexpr float kPlain = 64 * .03F * .03F;

}  // namespace

FlowPatch::Corner::Corner(float y, float x, int size, const Array2<float>& rimmed) noexcept {
    y = std::clamp(y + kRim, 0.F, float(rimmed.height() - size - 1));
    x = std::clamp(x + kRim, 0.F, float(rimmed.width() - size - 1));
    row = int(y);
    column = int(x);
    const float v = y - float(row), u = x - float(column);
    a = (1 - u) * (1 - v);
    b = u * (1 - v);
    c = (1 - u) * v;
    d = u * v;
}

FlowPatch::FlowPatch(const Array2<float>& now, const Array2<float>& gradient_x,
                     const Array2<float>& gradient_y, const Array2<float>& then, int top,
                     int left) noexcept
    : then_(&then), x0_(left), y0_(top) {
    float mean_x = 0, mean_y = 0, mean = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const auto i = std::size_t(y * kSide + x);
            mean_x += gx_[i] = gradient_x(y0_ + y, x0_ + x);
            mean_y += gy_[i] = gradient_y(y0_ + y, x0_ + x);
            mean += seen_[i] = now(y0_ + y + kRim, x0_ + x + kRim);
        }
    constexpr float kShare = 1.F / (kSide * kSide);
    float a = kPlain, b = 0, c = kPlain;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
        gx_[i] -= kShare * mean_x;
        gy_[i] -= kShare * mean_y;
        seen_[i] -= kShare * mean;
        a += gx_[i] * gx_[i];
        b += gx_[i] * gy_[i];
        c += gy_[i] * gy_[i];
    }
    const float determinant = a * c - b * b;  // > 0: kPlain
    texture_ = determinant / (a + c);
    xx_ = c / determinant;
    xy_ = -b / determinant;
    yy_ = a / determinant;
}

float FlowPatch::differences(FlowVector v, Pixels& difference) const noexcept {
    const Corner at{float(y0_) + v.y, float(x0_) + v.x, kSide, *then_};
    float mean = 0;
    for (int j = 0; j < kSide; ++j) {
        const float* upper = &(*then_)(at.row + j, at.column);
        const float* lower = upper + then_->width();
        for (int i = 0; i < kSide; ++i) {
            const auto k = std::size_t(j * kSide + i);
            difference[k] = at.a * upper[i] + at.b * upper[i + 1] + at.c * lower[i] +
                            at.d * lower[i + 1] - seen_[k];
            mean += difference[k];
        }
    }
    mean /= kSide * kSide;
    float squares = 0;
    for (float& value : difference) {
        value -= mean;
        squares += value * value;
    }
    return squares;
}

FlowVector FlowPatch::descend(FlowVector from) const noexcept {
    Pixels difference;
    FlowVector best = from, at = from;
    float least = INFINITY;
    for (int step = 0; step < kMaxSteps; ++step) {
        const float squares = differences(at, difference);
        if (!(squares < least)) break;
        least = squares;
        best = at;
        float x = 0, y = 0;
        for (std::size_t i = 0; i < difference.size(); ++i) {
            x += gx_[i] * difference[i];
            y += gy_[i] * difference[i];
        }
        const FlowVector by{xx_ * x + xy_ * y, xy_ * x + yy_ * y};
        if (by.x * by.x + by.y * by.y < 1e-5F) break;
        at = {at.x - by.x, at.y - by.y};
    }
    const bool lost = std::hypot(best.x - from.x, best.y - from.y) > kFurthest;
    return lost ? from : best;
}

}  // namespace eventide
