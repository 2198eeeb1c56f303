// Where what a frame shows was in an earlier one: dense inverse search.
#include "src/model/render/patch_flow.h"

#include "src/model/render/half_maps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace eventide {
namespace {

constexpr int kStride = 4;         // px from patch to patch
constexpr int kSmallestSide = 16;  // px, of the coarsest level
// Patches of less contrast than this (grey levels a px) count for less where several overlap.
constexpr float kTexture = 64 * .003F * .003F;
// Events per pixel that double what a patch must gain to be taken to have moved.
constexpr float kStill = 1;
// Differences that count as one grey level of 256 or less count alike.
constexpr float kGreyLevel = 1 / 255.F;

/// Means of three by three pixels that lie kStride apart.
void smooth(Array2<float>& map) noexcept {
    for (const bool across : {false, true}) {
        const int lines = across ? map.width() : map.height(),
                  size = across ? map.height() : map.width();
        for (int line = 0; line < lines; ++line) {
            const auto at = [&](int i) -> float& {
                i = std::clamp(i, 0, size - 1);
                return across ? map(i, line) : map(line, i);
            };
            std::array<float, std::size_t(kStride)> before;  // as they were
            for (int i = 0; i < kStride; ++i) before[std::size_t(i)] = at(0);
            for (int i = 0; i < size; ++i) {
                float& old = before[std::size_t(i % kStride)];
                const float value = at(i), mean = (old + value + at(i + kStride)) / 3;
                old = value;
                at(i) = mean;
            }
        }
    }
}

}  // namespace

MotionField::MotionField(int width, int height)
    : dx((height + 1) / 2, (width + 1) / 2), dy((height + 1) / 2, (width + 1) / 2) {}

PatchFlow::PatchFlow(int width, int height)
    : clipped_(height, width),
      mismatch_((height + 1) / 2, (width + 1) / 2),
      quarter_((height + 3) / 4, (width + 3) / 4) {
    for (int k = 0; k == 0 || std::min(width, height) >= 2 * kSmallestSide; ++k) {
        width = (width + 1) / 2;
        height = (height + 1) / 2;
        Level level;
        level.width = width;
        level.height = height;
        halves_.emplace_back(height, width);
        if (width >= FlowPatch::kSide && height >= FlowPatch::kSide) {
            level.columns = (width - FlowPatch::kSide + kStride - 1) / kStride + 1;
            level.rows = (height - FlowPatch::kSide + kStride - 1) / kStride + 1;
        }
        const std::size_t patches = std::size_t(level.columns) * std::size_t(level.rows);
        level.patches.reserve(patches);
        level.motions.resize(patches);
        level.patch_events.resize(patches);
        for (Array2<float>* map : {&level.now, &level.then})
            *map = Array2<float>(height + 2 * FlowPatch::kRim, width + 2 * FlowPatch::kRim);
        for (Array2<float>* map : {&level.gradient_x, &level.gradient_y, &level.events, &level.dx,
                                   &level.dy, &level.weight})
            *map = Array2<float>(height, width);
        levels_.push_back(std::move(level));
    }
}

void PatchFlow::set_level(const Array2<float>& plain, Array2<float>& rimmed) noexcept {
    for (int y = 0; y < rimmed.height(); ++y) {
        const auto from = plain.row(std::clamp(y - FlowPatch::kRim, 0, plain.height() - 1));
        const auto to = rimmed.row(y);
        std::ranges::fill(to.first(FlowPatch::kRim), from.front());
        std::ranges::copy(from, to.begin() + FlowPatch::kRim);
        std::ranges::fill(to.last(FlowPatch::kRim), from.back());
    }
}

void PatchFlow::differentiate(Level& level) noexcept {
    for (int y = 0; y < level.height; ++y)
        for (int x = 0; x < level.width; ++x) {
            const int v = y + FlowPatch::kRim, u = x + FlowPatch::kRim;
            level.gradient_x(y, x) = .5F * (level.now(v, u + 1) - level.now(v, u - 1));
            level.gradient_y(y, x) = .5F * (level.now(v + 1, u) - level.now(v - 1, u));
        }
}

void PatchFlow::set_patches(Level& level) noexcept {
    level.patches.clear();
    for (int row = 0; row < level.rows; ++row)
        for (int column = 0; column < level.columns; ++column) {
            const int top = std::min(row * kStride, level.height - FlowPatch::kSide);
            const int left = std::min(column * kStride, level.width - FlowPatch::kSide);
            float events = 0;
            for (int y = 0; y < FlowPatch::kSide; ++y)
                for (int x = 0; x < FlowPatch::kSide; ++x)
                    events += level.events(top + y, left + x);
            level.patch_events[level.patches.size()] =
                events / (FlowPatch::kSide * FlowPatch::kSide);
            level.patches.emplace_back(level.now, level.gradient_x, level.gradient_y, level.then,
                                       top, left);
        }
}

/// Each patch at the motion of its middle, `scale` px of this level for one of the map's.
void PatchFlow::begin_at(const Array2<float>& dx, const Array2<float>& dy, float scale,
                         Level& level) noexcept {
    for (std::size_t i = 0; i < level.patches.size(); ++i) {
        const int y = level.patches[i].top() + FlowPatch::kSide / 2;
        const int x = level.patches[i].left() + FlowPatch::kSide / 2;
        const int v = std::min(y * dx.height() / level.height, dx.height() - 1);
        const int u = std::min(x * dx.width() / level.width, dx.width() - 1);
        level.motions[i] = {scale * dx(v, u), scale * dy(v, u)};
    }
}

/// In reading order each patch looks at where those left of it and above it ended, too; backward,
/// at those right of it and below. Those without events stay where they are.
void PatchFlow::search(Level& level, bool backward) noexcept {
    FlowPatch::Pixels scratch;
    const int count = level.rows * level.columns, next = backward ? 1 : -1;
    for (int n = 0; n < count; ++n) {
        const int i = backward ? count - 1 - n : n;
        const int row = i / level.columns, column = i % level.columns;
        const FlowPatch& patch = level.patches[std::size_t(i)];
        FlowVector& motion = level.motions[std::size_t(i)];
        if (level.patch_events[std::size_t(i)] == 0) {
            motion = {};
            continue;
        }
        FlowVector from = motion;
        float least = patch.differences(from, scratch);
        const auto try_that_of = [&](int other_row, int other_column) {
            if (other_row < 0 || other_row >= level.rows || other_column < 0 ||
                other_column >= level.columns)
                return;
            const FlowVector other =
                level.motions[std::size_t(other_row * level.columns + other_column)];
            const float squares = patch.differences(other, scratch);
            if (!(squares < least)) return;
            least = squares;
            from = other;
        };
        try_that_of(row, column + next);
        try_that_of(row + next, column);
        motion = patch.descend(from);
    }
}

/// A patch that fits nearly as well where it was has not moved: within a factor of 1 + kStill / n
/// in squares, n events per pixel.
void PatchFlow::keep_still(Level& level) noexcept {
    FlowPatch::Pixels scratch;
    for (std::size_t i = 0; i < level.patches.size(); ++i) {
        FlowVector& motion = level.motions[i];
        if (motion.x == 0 && motion.y == 0) continue;
        const float events = level.patch_events[i];
        const float there = level.patches[i].differences({}, scratch),
                    here = level.patches[i].differences(motion, scratch);
        if (events * there <= (events + kStill) * here) motion = {};
    }
}

/// The motion of each pixel: the mean of the patches over it and near it, each weighted by its
/// contrast and by how well it fits there.
void PatchFlow::spread(Level& level) noexcept {
    for (Array2<float>* map : {&level.dx, &level.dy, &level.weight}) fill(*map, 0);
    FlowPatch::Pixels difference;
    for (std::size_t i = 0; i < level.patches.size(); ++i) {
        const FlowPatch& patch = level.patches[i];
        const FlowVector motion = level.motions[i];
        patch.differences(motion, difference);
        FlowPatch::Pixels weights;
        for (std::size_t k = 0; k < weights.size(); ++k)
            weights[k] =
                (kTexture + patch.texture()) / std::max(kGreyLevel, std::abs(difference[k]));
        const auto add = [&](float times, Array2<float>& map) {
            const float* weight = weights.data();
            for (int y = 0; y < FlowPatch::kSide; ++y, weight += FlowPatch::kSide) {
                float* row = &map(patch.top() + y, patch.left());
                for (int x = 0; x < FlowPatch::kSide; ++x) row[x] += times * weight[x];
            }
        };
        add(1, level.weight);
        if (motion.x != 0) add(motion.x, level.dx);
        if (motion.y != 0) add(motion.y, level.dy);
    }
    for (Array2<float>* map : {&level.dx, &level.dy, &level.weight}) smooth(*map);
    for (std::size_t i = 0; i < level.weight.values().size(); ++i) {
        const float weight = level.weight.values()[i];
        if (weight <= 0) continue;
        level.dx.values()[i] /= weight;
        level.dy.values()[i] /= weight;
    }
}

/// Means over 2 x 2 px of the finest level, that is 4 x 4 of the frames.
void PatchFlow::compare() noexcept {
    const Level& finest = levels_.front();
    for (int y = 0; y < finest.height; ++y)
        for (int x = 0; x < finest.width; ++x) {
            const FlowPatch::Corner at{float(y) + finest.dy(y, x), float(x) + finest.dx(y, x), 1,
                                       finest.then};
            const float *upper = &finest.then(at.row, at.column),
                        *lower = &finest.then(at.row + 1, at.column);
            const float then =
                at.a * upper[0] + at.b * upper[1] + at.c * lower[0] + at.d * lower[1];
            mismatch_(y, x) = std::abs(then - finest.now(y + FlowPatch::kRim, x + FlowPatch::kRim));
        }
    halve(mismatch_, quarter_);
    fill(mismatch_, 0);
    add_doubled(quarter_, mismatch_);
}

void PatchFlow::find(const Array2<float>& now, const Array2<float>& then,
                     const Array2<float>& events, MotionField& motion) noexcept {
    const Array2<float>* finer_events = &events;
    for (Level& level : levels_) {
        halve(*finer_events, level.events);
        finer_events = &level.events;
    }
    for (const bool other : {false, true}) {
        const Array2<float>& frame = other ? then : now;
        std::ranges::transform(frame.values(), clipped_.values().begin(),
                               [](float v) { return v > 0 ? std::min(v, 1.F) : 0; });
        const Array2<float>* finer = &clipped_;
        for (std::size_t k = 0; k < levels_.size(); ++k) {
            halve(*finer, halves_[k]);
            finer = &halves_[k];
            set_level(*finer, other ? levels_[k].then : levels_[k].now);
        }
    }
    for (std::size_t k = levels_.size(); k-- > 0;) {
        Level& level = levels_[k];
        differentiate(level);
        set_patches(level);
        if (k + 1 == levels_.size())
            begin_at(motion.dx, motion.dy, 1 / float(2 << k), level);
        else
            begin_at(levels_[k + 1].dx, levels_[k + 1].dy, 2, level);
        search(level, false);
        search(level, true);
        keep_still(level);
        spread(level);
    }
    compare();
    const Level& finest = levels_.front();
    for (std::size_t i = 0; i < motion.dx.values().size(); ++i) {
        motion.dx.values()[i] = 2 * finest.dx.values()[i];
        motion.dy.values()[i] = 2 * finest.dy.values()[i];
    }
}

}  // namespace eventide
