// Mirrored views of what a sensor sees: the networks of a geometric self-ensemble see one each.
#pragma once

#include "src/core/frame_data.h"
#include "src/model/render/sampling.h"

#include <array>

namespace eventide {

/// Which axes are mirrored. Mirrored twice is as it was.
struct Mirror {
    bool x = false, y = false;
};

/// The views of an ensemble of N are the first N: as seen, turned by half a turn, left for right,
/// top for bottom.
constexpr std::array<Mirror, 4> kMirrors{
    {{false, false}, {true, true}, {true, false}, {false, true}}};

/// Into one of the same size, with the stamp.
void mirror(const VoxelGrid& grid, Mirror axes, VoxelGrid& into) noexcept;
/// In place.
void mirror(Array2<float>& map, Mirror axes) noexcept;
/// The same part of the frame where it lies in the mirrored frame.
FrameGeometry mirror(FrameGeometry geometry, Mirror axes) noexcept;

/// How many views an ensemble may have: 1, 2 or 4. Throws Error (usage) for another number.
void check_self_ensemble(int views);

/// The root of the squared error of an ensemble's mean over that of one view: its members err less
/// together. Measured on scenes of another simulator (docs/model.md, "Self-ensemble").
double error_of_mean(int views);

}  // namespace eventide
