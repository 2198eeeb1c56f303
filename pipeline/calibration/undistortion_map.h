// Which place of a camera's frame each pixel of the undistorted frame shows.
#pragma once

#include "pipeline/calibration/calibration.h"
#include "src/core/array.h"

#include <eventide/frame.h>

namespace eventide {

/// px, the middle of the first pixel at 0; where a pixel shows nothing the lens took, both are
/// kNowhere.
struct SourcePlaces {
    static constexpr float kNowhere = -1e6f;
    Array2<float> x, y;  ///< [y][x] of the undistorted frame
};

/// The calibration of a camera without distortion that looks as the projection matrix says: that of
/// the frames that come out.
Calibration undistorted(const Calibration& calibration);

/// Where each pixel of `region` of the undistorted frame, which is as large as calibration says,
/// lies in the frame as it is rendered (whole). Plumb bob, rational polynomial and equidistant
/// (OpenCV 4, calib3d, "Detailed Description" and fisheye). Rays beyond the one at which the lens
/// model turns back are nowhere: no lens shows a place twice.
SourcePlaces source_places(const Calibration& calibration, const Region& region);

/// The smallest part of the frame that holds all places that lie in it, and `margin` px more each
/// way for interpolation. Width 0: none does.
Region region_of(const SourcePlaces& places, int width, int height, int margin);

}  // namespace eventide
