// The sensor's own images of the last moments.
#include "apps/cli/run/reference_images.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <chrono>

namespace eventide::app {

namespace {

/// 8 bits: grey, weighed as cvtColor does, or in colour where the image is (BGR).
cv::Mat shown_of(const ReferenceImage& image, bool in_colour) {
    const int width = image.pixels.width() / image.channels;
    const cv::Mat wide(image.pixels.height(), width, CV_MAKETYPE(CV_16U, image.channels),
                       const_cast<std::uint16_t*>(image.pixels.values().data()));
    cv::Mat narrow, shown;
    wide.convertTo(narrow, CV_8U, 1.0 / 257);
    if (image.channels == 1 || (in_colour && image.channels == 3)) return narrow;
    const int to_grey = image.channels == 3 ? cv::COLOR_BGR2GRAY : cv::COLOR_BGRA2GRAY;
    cv::cvtColor(narrow, shown, in_colour ? int(cv::COLOR_BGRA2BGR) : to_grey);
    return shown;
}

std::size_t bytes_of(const ReferenceImage& image) {
    return image.pixels.values().size_bytes();
}

}  // namespace

void ReferenceImages::see(const Batch& batch) {
    if (batch.images.empty()) return;
    const std::lock_guard lock{mutex_};
    for (const ReferenceImage& image : batch.images) {
        images_.push_back(image);
        bytes_ += bytes_of(image);
    }
    for (; is_one_too_many(); images_.pop_front()) bytes_ -= bytes_of(images_.front());
}

/// After the clock began anew, too, times are far apart.
bool ReferenceImages::is_one_too_many() const {
    if (images_.size() <= kKeptAnyway) return false;
    return bytes_ > kMostBytes || std::chrono::abs(images_.back().t - images_.front().t) > kKept;
}

SensorDuration ReferenceImages::spacing_at(std::size_t image) const {
    SensorDuration nearest{0};
    const auto neighbour = [&](std::size_t other) {
        const SensorDuration apart = std::chrono::abs(images_[image].t - images_[other].t);
        nearest = nearest.count() == 0 ? apart : std::min(nearest, apart);
    };
    if (image > 0) neighbour(image - 1);
    if (image + 1 < images_.size()) neighbour(image + 1);
    return nearest;
}

std::optional<std::size_t> ReferenceImages::nearest_to(SensorTime t) const {
    const auto distance = [&](const ReferenceImage& image) {
        return std::chrono::abs(image.t - t);
    };
    const auto nearest = std::ranges::min_element(images_, {}, distance);
    if (nearest == images_.end()) return std::nullopt;
    return std::size_t(nearest - images_.begin());
}

void ReferenceImages::draw(SensorTime t, const Window& window, cv::Size sensor,
                           cv::Mat& shown) const {
    const std::lock_guard lock{mutex_};
    const auto image = nearest_to(t);
    if (image && 2 * std::chrono::abs(images_[*image].t - t) <= window.width())
        draw(images_[*image], sensor, false, shown);
}

void ReferenceImages::draw_nearest(SensorTime t, const Window& window, cv::Size sensor,
                                   bool in_colour, cv::Mat& shown) const {
    const std::lock_guard lock{mutex_};
    const auto image = nearest_to(t);
    if (image &&
        2 * std::chrono::abs(images_[*image].t - t) <= std::max(window.width(), spacing_at(*image)))
        draw(images_[*image], sensor, in_colour, shown);
}

void ReferenceImages::draw(const ReferenceImage& image, cv::Size sensor, bool in_colour,
                           cv::Mat& shown) const {
    const cv::Mat seen = shown_of(image, in_colour);
    shown = cv::Mat::zeros(sensor, seen.type());
    const cv::Rect whole{{0, 0}, sensor};
    const cv::Rect place = cv::Rect{image.x0, image.y0, seen.cols, seen.rows} & whole;
    if (place.empty()) return;  // nothing of it lies on the sensor
    seen(place - cv::Point{image.x0, image.y0}).copyTo(shown(place));
}

}  // namespace eventide::app
