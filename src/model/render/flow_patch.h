// A patch of a frame that looks for its place in another one.
#pragma once

#include "src/core/array.h"

#include <array>
#include <cstddef>

namespace eventide {

struct FlowVector {
    float x = 0, y = 0;  ///< px
};

/// One patch of the frame at hand, and how well a place in the other fits it.
class FlowPatch {
public:
    static constexpr int kSide = 8;  ///< px
    /// px that frames repeat their edges: so far a patch may reach.
    static constexpr int kRim = 16;
    using Pixels = std::array<float, std::size_t(kSide* kSide)>;

    /// A place in a map with a rim, and the weights of the four pixels around it.
    struct Corner {
        int row, column;   ///< of the map
        float a, b, c, d;  ///< upper left, upper right, lower left, lower right

        /// `size`: px of what is read there; it stays within the rim.
        Corner(float y, float x, int size, const Array2<float>& rimmed) noexcept;
    };

    /// Frames with a rim, gradients without one; they are borrowed. The patch's upper left corner.
    FlowPatch(const Array2<float>& now, const Array2<float>& gradient_x,
              const Array2<float>& gradient_y, const Array2<float>& then, int top,
              int left) noexcept;

    int top() const { return top_; }
    int left() const { return left_; }
    /// How much there is to align by in the direction that has least: half to all of the sum of the
    /// squares of its gradients.
    float texture() const { return texture_; }

    /// The other frame, displaced by v, less this one; the means are left out. Returns the sum of
    /// squares.
    float differences(FlowVector v, Pixels& difference) const noexcept;

    /// Where Lucas-Kanade steps lead from `from`, as long as they help.
    FlowVector descend(FlowVector from) const noexcept;

private:
    FlowVector slope(const Pixels& difference) const noexcept;

    const Array2<float>*now_, *gradient_x_, *gradient_y_, *then_;
    int top_, left_;
    float xx_ = 0, xy_ = 0, yy_ = 0;  // the inverse of the squares of the gradients
    float texture_ = 0;
};

}  // namespace eventide
