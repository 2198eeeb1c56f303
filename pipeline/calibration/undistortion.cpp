// Frames as a camera without distortion would have them.
#include "pipeline/calibration/undistortion.h"

#include "pipeline/calibration/undistortion_map.h"
#include "src/core/error.h"
#include "src/core/frame_stamp.h"

#include <string>
#include <utility>

namespace eventide {

namespace {

constexpr int kCubicReach = 2;  // px beside a place

std::string text_of(const Region& region) {
    return std::to_string(region.x) + "," + std::to_string(region.y) + "," +
           std::to_string(region.width) + "x" + std::to_string(region.height);
}

}  // namespace

UndistortionPlan plan_undistortion(const Calibration& sensor, int width, int height,
                                   const Region& region) {
    if (region.x < 0 || region.y < 0 || region.width > width - region.x ||
        region.height > height - region.y)
        throw Error(ErrorKind::usage, "--roi " + text_of(region) +
                                          ": expected a part of the undistorted frame of " +
                                          std::to_string(width) + "x" + std::to_string(height));
    UndistortionPlan plan;
    plan.calibration = fitted(sensor, {}, width, height);
    plan.width = width;
    plan.height = height;
    plan.fixed = region.width > 0;
    plan.region = plan.fixed ? region : Region{0, 0, width, height};
    plan.source = {0, 0, width, height};
    if (!plan.fixed) return plan;
    plan.source =
        region_of(source_places(plan.calibration, plan.region), width, height, kCubicReach);
    if (plan.source.width == 0)
        throw Error(ErrorKind::usage, "--roi " + text_of(region) +
                                          ": nothing of this part of the undistorted frame was "
                                          "seen by the camera (--undistort)");
    return plan;
}

Calibration undistorted_sensor(const UndistortionPlan& plan) {
    return undistorted(plan.calibration);
}

Undistortion::Undistortion(UndistortionPlan plan) : plan_{std::move(plan)} {
    make_map(plan_.width, plan_.height);
}

void Undistortion::make_map(int width, int height) {
    if (width != plan_.width || height != plan_.height) {
        plan_.calibration = fitted(plan_.calibration, {}, width, height);
        plan_.width = width;
        plan_.height = height;
        plan_.region = plan_.source = {0, 0, width, height};
    }
    map_.emplace(source_places(plan_.calibration, plan_.region), plan_.source);
}

const Frame& Undistortion::apply(const Frame& frame) {
    const int width = frame.intensity.width(), height = frame.intensity.height();
    if (!plan_.fixed && (width != map_->source_width() || height != map_->source_height()))
        make_map(width, height);
    copy_stamp(frame, shown_);
    map_->apply(frame.intensity, shown_.intensity, Resampling::cubic, 0);
    if (frame.sigma.empty())
        shown_.sigma = {};
    else
        map_->apply(frame.sigma, shown_.sigma, Resampling::linear, kUnseen);
    for (std::size_t c = 0; c < frame.colour.size(); ++c)
        if (frame.colour[c].empty())
            shown_.colour[c] = {};
        else
            map_->apply(frame.colour[c], shown_.colour[c], Resampling::cubic, 0);
    const Array2<float>& events = frame.event_preview;
    if (events.empty()) {
        shown_.event_preview = {};
        return shown_;
    }
    if (!preview_map_) {
        const Region all{0, 0, events.width(), events.height()};
        preview_map_.emplace(
            source_places(fitted(plan_.calibration, {}, events.width(), events.height()), all),
            all);
    }
    preview_map_->apply(events, shown_.event_preview, Resampling::nearest, 0);
    return shown_;
}

}  // namespace eventide
