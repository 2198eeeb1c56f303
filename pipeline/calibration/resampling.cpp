// Planes taken at other places: a few taps each way, with weights out of a table.
#include "pipeline/calibration/resampling.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace eventide {

namespace {

constexpr int kSteps = 32;  // of a pixel
constexpr std::int32_t kNothing = std::numeric_limits<std::int32_t>::min();

/// For each 32nd between two pixels, the weights of the pixels from `kTaps / 2 - 1` before on.
template <int kTaps>
using WeightTable = std::array<std::array<float, kTaps>, kSteps>;

WeightTable<1> nearest_weights() {
    WeightTable<1> table;
    table.fill({1});
    return table;
}

WeightTable<2> linear_weights() {
    WeightTable<2> table;
    for (int i = 0; i < kSteps; ++i) {
        const float along = float(i) / kSteps;
        table[std::size_t(i)] = {1 - along, along};
    }
    return table;
}

WeightTable<4> cubic_weights() {
    constexpr double kA = -.75;  // slope at a distance of 1
    const auto near = [](double d) { return ((kA + 2) * d - (kA + 3)) * d * d + 1; };
    const auto far = [](double d) { return ((kA * d - 5 * kA) * d + 8 * kA) * d - 4 * kA; };
    WeightTable<4> table;
    for (int i = 0; i < kSteps; ++i) {
        const double along = double(i) / kSteps;
        table[std::size_t(i)] = {float(far(1 + along)), float(near(along)), float(near(1 - along)),
                                 float(far(2 - along))};
    }
    return table;
}

template <int kTaps>
float weighed(const std::array<float, kTaps>& weights, const float* values) {
    if constexpr (kTaps == 4)
        return (weights[0] * values[0] + weights[1] * values[1]) +
               (weights[2] * values[2] + weights[3] * values[3]);
    else if constexpr (kTaps == 2)
        return weights[0] * values[0] + weights[1] * values[1];
    else
        return weights[0] * values[0];
}

}  // namespace

ResamplingMap::ResamplingMap(const SourcePlaces& places, const Region& source)
    : width_(places.x.width()),
      height_(places.x.height()),
      source_width_(source.width),
      source_height_(source.height) {
    const auto xs = places.x.values(), ys = places.y.values();
    places_.reserve(xs.size());
    // To the edges of the outer pixels, which reach half a pixel beyond their middles.
    const auto inside = [](float at, int begin, int size) {
        return at >= float(begin) - .5F && at <= float(begin + size) - .5F;
    };
    const auto steps = [](float at, int begin) {
        return std::int32_t(std::lround(double(at) * kSteps)) - begin * kSteps;
    };
    for (std::size_t i = 0; i < xs.size(); ++i) {
        const bool seen =
            inside(xs[i], source.x, source.width) && inside(ys[i], source.y, source.height);
        places_.push_back(seen ? Place{steps(xs[i], source.x), steps(ys[i], source.y)}
                               : Place{kNothing, 0});
    }
}

template <int kTaps, typename Weights>
void ResamplingMap::take(const Array2<float>& from, std::span<float> to, const Weights& weights,
                         float blank) const {
    constexpr int kBefore = kTaps > 1 ? kTaps / 2 - 1 : 0;
    constexpr int kToNearest = kTaps > 1 ? 0 : kSteps / 2;
    const int last_x = source_width_ - 1, last_y = source_height_ - 1;
    const float* const values = from.values().data();
    for (std::size_t i = 0; i < places_.size(); ++i) {
        const Place& place = places_[i];
        if (place.x == kNothing) {
            to[i] = blank;
            continue;
        }
        const std::int32_t at_x = place.x + kToNearest, at_y = place.y + kToNearest;
        // Rounded down, also below zero; 32 is a power of two.
        const auto& across = weights[std::size_t(at_x & (kSteps - 1))];
        const auto& down = weights[std::size_t(at_y & (kSteps - 1))];
        const int left = (at_x >> 5) - kBefore, top = (at_y >> 5) - kBefore;
        const bool whole =
            left >= 0 && top >= 0 && left + kTaps - 1 <= last_x && top + kTaps - 1 <= last_y;
        float sum = 0;
        if (whole) {
            const float* line = values + std::ptrdiff_t(top) * source_width_ + left;
            for (const float weight : down) {
                sum += weight * weighed<kTaps>(across, line);
                line += source_width_;
            }
        } else {
            std::array<float, kTaps> line;
            for (int row = 0; row < kTaps; ++row) {
                const int y = std::clamp(top + row, 0, last_y);
                for (int column = 0; column < kTaps; ++column)
                    line[std::size_t(column)] = from(y, std::clamp(left + column, 0, last_x));
                sum += down[std::size_t(row)] * weighed<kTaps>(across, line.data());
            }
        }
        to[i] = sum;
    }
}

void ResamplingMap::apply(const Array2<float>& from, Array2<float>& to, Resampling how,
                          float blank) const {
    assert(from.width() == source_width_ && from.height() == source_height_);
    static const auto nearest = nearest_weights();
    static const auto linear = linear_weights();
    static const auto cubic = cubic_weights();
    if (to.height() != height_ || to.width() != width_) to = Array2<float>{height_, width_};
    switch (how) {
        case Resampling::nearest:
            return take<1>(from, to.values(), nearest, blank);
        case Resampling::linear:
            return take<2>(from, to.values(), linear, blank);
        case Resampling::cubic:
            return take<4>(from, to.values(), cubic, blank);
    }
}

}  // namespace eventide
