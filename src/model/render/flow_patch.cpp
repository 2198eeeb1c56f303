// A patch of a frame that looks for its place in another one.
#include "src/model/render/flow_patch.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace eventide {
namespace {

constexpr int kMaxSteps = 12;
// A patch that ends further than this from where it began has lost its way.
constexpr float kFurthest = 8;
// Added to the squares of gradients, so that noise on plain surfaces does not move a patch.
constexpr float kPlain = 64 * .03F * .03F;

// Half a row of a patch: a register of what the program is compiled for, whatever the processor has
// besides, so that sums are the same everywhere. Compilers do not find these vectors by themselves,
// as the order of a sum is not theirs to change.
using Four [[gnu::vector_size(16)]] = float;

Four load(const float* from) {
    Four four;
    std::memcpy(&four, from, sizeof four);
    return four;
}
void store(Four four, float* to) {
    std::memcpy(to, &four, sizeof four);
}
float total(Four sums) {
    return (sums[0] + sums[2]) + (sums[1] + sums[3]);
}

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
    : now_(&now),
      gradient_x_(&gradient_x),
      gradient_y_(&gradient_y),
      then_(&then),
      top_(top),
      left_(left) {
    Four x{}, y{}, xx{}, xy{}, yy{};
    for (int j = 0; j < kSide; ++j) {
        const float *along_x = &gradient_x(top + j, left), *along_y = &gradient_y(top + j, left);
        for (int i = 0; i < kSide; i += 4) {
            const Four u = load(along_x + i), v = load(along_y + i);
            x += u;
            y += v;
            xx += u * u;
            xy += u * v;
            yy += v * v;
        }
    }
    // The means are left out.
    constexpr float kShare = 1.F / (kSide * kSide);
    const float sum_x = total(x), sum_y = total(y);
    const float a = kPlain + std::max(0.F, total(xx) - kShare * sum_x * sum_x);
    const float b = total(xy) - kShare * sum_x * sum_y;
    const float c = kPlain + std::max(0.F, total(yy) - kShare * sum_y * sum_y);
    const float determinant = a * c - b * b;  // > 0: kPlain
    texture_ = determinant / (a + c);
    xx_ = c / determinant;
    xy_ = -b / determinant;
    yy_ = a / determinant;
}

float FlowPatch::differences(FlowVector v, Pixels& difference) const noexcept {
    const Corner at{float(top_) + v.y, float(left_) + v.x, kSide, *then_};
    Four sum{};
    for (int j = 0; j < kSide; ++j) {
        const float *upper = &(*then_)(at.row + j, at.column), *lower = upper + then_->width();
        const float* here = &(*now_)(top_ + j + kRim, left_ + kRim);
        for (int i = 0; i < kSide; i += 4) {
            const Four there = (at.a * load(upper + i) + at.b * load(upper + i + 1)) +
                               (at.c * load(lower + i) + at.d * load(lower + i + 1));
            const Four less = there - load(here + i);
            store(less, &difference[std::size_t(j * kSide + i)]);
            sum += less;
        }
    }
    const float mean = total(sum) / (kSide * kSide);
    Four squares{};
    for (std::size_t k = 0; k < difference.size(); k += 4) {
        const Four less = load(&difference[k]) - mean;
        store(less, &difference[k]);
        squares += less * less;
    }
    return total(squares);
}

/// The sums of the differences times the gradients; as their mean is 0, that of the gradients need
/// not be left out.
FlowVector FlowPatch::slope(const Pixels& difference) const noexcept {
    Four x{}, y{};
    for (int j = 0; j < kSide; ++j) {
        const float *along_x = &(*gradient_x_)(top_ + j, left_),
                    *along_y = &(*gradient_y_)(top_ + j, left_);
        for (int i = 0; i < kSide; i += 4) {
            const Four by = load(&difference[std::size_t(j * kSide + i)]);
            x += by * load(along_x + i);
            y += by * load(along_y + i);
        }
    }
    return {total(x), total(y)};
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
        const auto [x, y] = slope(difference);
        const FlowVector by{xx_ * x + xy_ * y, xy_ * x + yy_ * y};
        if (by.x * by.x + by.y * by.y < 1e-5F) break;
        at = {at.x - by.x, at.y - by.y};
    }
    const bool lost = std::hypot(best.x - from.x, best.y - from.y) > kFurthest;
    return lost ? from : best;
}

}  // namespace eventide
