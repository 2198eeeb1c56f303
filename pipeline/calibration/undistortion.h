// Frames as a camera without distortion would have them.
#pragma once

#include "pipeline/calibration/calibration.h"
#include "pipeline/calibration/resampling.h"
#include "pipeline/sinks/changing_sink.h"

#include <eventide/frame.h>

#include <memory>
#include <optional>
#include <vector>

namespace eventide {

/// What is to be undistorted, and what has to be rendered for it.
struct UndistortionPlan {
    Calibration calibration;    ///< of the whole frame as it is rendered
    Region region;              ///< px, of the undistorted frame: what is wanted
    Region source;              ///< px, of the rendered frame: what that takes
    int width = 0, height = 0;  ///< px, of the whole frame, before and after alike
    bool fixed = false;         ///< a region was asked for: frames keep their size
};

/// `sensor` as read; frames of width x height px, of which `region` is wanted (width 0: all).
/// Throws Error (usage) where the region shows nothing that the lens took.
UndistortionPlan plan_undistortion(const Calibration& sensor, int width, int height,
                                   const Region& region);

/// The calibration of the whole undistorted frame.
Calibration undistorted_sensor(const UndistortionPlan& plan);

/// Intensity is interpolated cubically, sigma linearly. Where the camera saw nothing, intensity is
/// 0 and sigma kUnseen. Maps are made at the start, and
/// anew where frames change their size.
class Undistortion {
public:
    /// The root mean square distance of 0 from an intensity of which nothing is known but that it
    /// lies in 0 to 1.
    static constexpr float kUnseen = 0.57735f;

    explicit Undistortion(UndistortionPlan plan);

    /// The undistorted frame, borrowed until the next call.
    const Frame& apply(const Frame& frame);

private:
    void make_map(int width, int height);

    UndistortionPlan plan_;
    std::optional<ResamplingMap> map_, preview_map_;
    Frame shown_;
};

class UndistortionSink final : public ChangingSink {
public:
    UndistortionSink(UndistortionPlan plan, std::vector<std::unique_ptr<Sink>> behind)
        : ChangingSink{std::move(behind)}, undistortion_{std::move(plan)} {}

private:
    const Frame& changed(const Frame& frame) override { return undistortion_.apply(frame); }

    Undistortion undistortion_;
};

}  // namespace eventide
