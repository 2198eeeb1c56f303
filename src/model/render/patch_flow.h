// Where what a frame shows was in an earlier one.
#pragma once

#include "src/core/array.h"
#include "src/model/render/flow_patch.h"

#include <vector>

namespace eventide {

/// What is at (y, x) of one frame is at (y + dy, x + dx) of another. px of the frames; held at half
/// their size, [(height + 1) / 2][(width + 1) / 2], for motion is smoother than what moves.
struct MotionField {
    MotionField() = default;
    MotionField(int width, int height);

    Array2<float> dx, dy;
};

/// Optical flow by dense inverse search (Kroeger et al. 2016, arXiv 1603.03590) without its
/// variational refinement: patches of 8 x 8 px, four px apart, on a pyramid of halved frames; each
/// begins where the patches around it and those of the level above ended, and descends by
/// Lucas-Kanade steps whose gradients are those of the frame at hand. Frames may differ in
/// brightness: each patch is compared without its mean.
///
/// One thread at a time; nothing is allocated after construction, nothing fails. The same frames
/// give the same bits everywhere that the same program runs. (OpenCV's has results that depend on
/// its number of threads, and its library brings dnn's with it.)
class PatchFlow {
public:
    PatchFlow(int width, int height);

    /// Intensities, [y][x], clipped to [0, 1]. `events`: per pixel since then; the fewer there
    /// were, the better a patch must fit elsewhere before it is taken to have moved; without any it
    /// has not. `motion`: where to begin, and what was found.
    void find(const Array2<float>& now, const Array2<float>& then, const Array2<float>& events,
              MotionField& motion) noexcept;

    /// How far the frames differ around each pixel, the motion found last taken into account: means
    /// of |difference|, 0 to 1, in the size of a motion field.
    const Array2<float>& mismatch() const { return mismatch_; }

private:
    struct Level {
        int width = 0, height = 0;             // px
        int columns = 0, rows = 0;             // patches
        Array2<float> now, then;               // with a rim that repeats the edge
        Array2<float> gradient_x, gradient_y;  // of now, without a rim
        Array2<float> events;                  // per pixel of the frames, without a rim
        std::vector<FlowPatch> patches;        // in reading order
        std::vector<FlowVector> motions;       // theirs, px of this level
        std::vector<float> patch_events;       // theirs, per pixel of the frames
        Array2<float> dx, dy, weight;          // dense
    };
    static void set_level(const Array2<float>& plain, Array2<float>& rimmed) noexcept;
    static void differentiate(Level& level) noexcept;
    static void set_patches(Level& level) noexcept;
    static void begin_at(const Array2<float>& dx, const Array2<float>& dy, float scale,
                         Level& level) noexcept;
    static void search(Level& level, bool backward) noexcept;
    static void keep_still(Level& level) noexcept;
    static void spread(Level& level) noexcept;
    void compare() noexcept;

    std::vector<Level> levels_;          // from half of the frames' size on
    std::vector<Array2<float>> halves_;  // scratch
    Array2<float> clipped_, mismatch_, quarter_;
};

}  // namespace eventide
