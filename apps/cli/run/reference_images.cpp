// The sensor's own images of the last moments.
#include "apps/cli/run/reference_images.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <chrono>

namespace eventide::app {

namespace {

/// 8-bit grey; colour sensors' images are weighed as cvtColor does.
cv::Mat grey_of(const ReferenceImage& image) {
    const int width = image.pixels.width() / image.channels;
    const cv::Mat wide(image.pixels.height(), width, CV_MAKETYPE(CV_16U, image.channels),
                       const_cast<std::uint16_t*>(image.pixels.values().data()));
    cv::Mat narrow, grey;
    wide.convertTo(narrow, CV_8U, 1.0 / 257);
    if (image.channels == 1) return narrow;
    cv::cvtColor(narrow, grey, image.channels == 3 ? cv::COLOR_BGR2GRAY : cv::COLOR_BGRA2GRAY);
    return grey;
}

}  // namespace

void ReferenceImages::see(const Batch& batch) {
    if (batch.images.empty()) return;
    const std::lock_guard lock{mutex_};
    for (const ReferenceImage& image : batch.images) images_.push_back(image);
    while (images_.size() > kKept) images_.pop_front();
}

void ReferenceImages::draw(const Frame& frame, int sensor_width, int sensor_height,
                           cv::Mat& shown) const {
    const std::lock_guard lock{mutex_};
    const auto distance = [&](const ReferenceImage& image) {
        return std::chrono::abs(image.t - frame.t);
    };
    const auto nearest = std::ranges::min_element(images_, {}, distance);
    if (nearest == images_.end() || distance(*nearest) > frame.window.width() / 2) return;
    const cv::Mat grey = grey_of(*nearest);
    shown = cv::Mat::zeros(sensor_height, sensor_width, CV_8UC1);
    const cv::Rect sensor{0, 0, sensor_width, sensor_height};
    const cv::Rect place = cv::Rect{nearest->x0, nearest->y0, grey.cols, grey.rows} & sensor;
    grey(place - cv::Point{nearest->x0, nearest->y0}).copyTo(shown(place));
}

}  // namespace eventide::app
