// Frames as a camera without distortion would have them.
#include "pipeline/calibration/undistortion.h"

#include "pipeline/calibration/undistortion_map.h"
#include "src/core/error.h"
#include "src/core/frame_stamp.h"

#include <opencv2/imgproc.hpp>

#include <cstdint>
#include <string>
#include <utility>

namespace eventide {

namespace {

constexpr int kCubicReach = 2;  // px beside a place

cv::Mat view_of(Array2<float>& plane) {
    return {plane.height(), plane.width(), CV_32FC1, plane.values().data()};
}
cv::Mat view_of(const Array2<float>& plane) {
    return {plane.height(), plane.width(), CV_32FC1, const_cast<float*>(plane.values().data())};
}

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

/// Fixed-point places as cv::remap() likes them, and the pixels that show nothing.
struct Undistortion::Map {
    int width, height;  // px, of the frames it is for
    cv::Mat places, fractions;
    std::vector<std::uint32_t> unseen;

    Map(const Calibration& calibration, const Region& region, const Region& source)
        : width{source.width}, height{source.height} {
        SourcePlaces from = source_places(calibration, region);
        const auto xs = from.x.values(), ys = from.y.values();
        for (std::size_t i = 0; i < xs.size(); ++i) {
            xs[i] -= float(source.x);
            ys[i] -= float(source.y);
            // To the edges of the outer pixels, which reach half a pixel beyond their middles.
            if (xs[i] >= -0.5f && ys[i] >= -0.5f && xs[i] <= float(width) - 0.5f &&
                ys[i] <= float(height) - 0.5f)
                continue;
            unseen.push_back(std::uint32_t(i));
            xs[i] = ys[i] = 0;
        }
        cv::convertMaps(view_of(from.x), view_of(from.y), places, fractions, CV_16SC2);
    }

    void apply(const Array2<float>& from, Array2<float>& to, int interpolation, float blank) const {
        if (to.height() != places.rows || to.width() != places.cols)
            to = Array2<float>{places.rows, places.cols};
        cv::Mat target = view_of(to);
        cv::remap(view_of(from), target, places, fractions, interpolation, cv::BORDER_REPLICATE);
        for (const std::uint32_t i : unseen) to.values()[i] = blank;
    }
};

Undistortion::Undistortion(UndistortionPlan plan) : plan_{std::move(plan)} {
    make_map(plan_.width, plan_.height);
}

Undistortion::~Undistortion() = default;
Undistortion::Undistortion(Undistortion&&) noexcept = default;

void Undistortion::make_map(int width, int height) {
    if (width != plan_.width || height != plan_.height) {
        plan_.calibration = fitted(plan_.calibration, {}, width, height);
        plan_.width = width;
        plan_.height = height;
        plan_.region = plan_.source = {0, 0, width, height};
    }
    map_ = std::make_unique<Map>(plan_.calibration, plan_.region, plan_.source);
}

const Frame& Undistortion::apply(const Frame& frame) {
    const int width = frame.intensity.width(), height = frame.intensity.height();
    if (!plan_.fixed && (width != map_->width || height != map_->height)) make_map(width, height);
    copy_stamp(frame, shown_);
    map_->apply(frame.intensity, shown_.intensity, cv::INTER_CUBIC, 0);
    if (frame.sigma.empty())
        shown_.sigma = {};
    else
        map_->apply(frame.sigma, shown_.sigma, cv::INTER_LINEAR, kUnseen);
    for (std::size_t c = 0; c < frame.colour.size(); ++c)
        if (frame.colour[c].empty())
            shown_.colour[c] = {};
        else
            map_->apply(frame.colour[c], shown_.colour[c], cv::INTER_CUBIC, 0);
    const Array2<float>& events = frame.event_preview;
    if (events.empty()) {
        shown_.event_preview = {};
        return shown_;
    }
    if (!preview_map_) {
        const Region all{0, 0, events.width(), events.height()};
        preview_map_ = std::make_unique<Map>(
            fitted(plan_.calibration, {}, events.width(), events.height()), all, all);
    }
    preview_map_->apply(events, shown_.event_preview, cv::INTER_NEAREST, 0);
    return shown_;
}

}  // namespace eventide
