// The sensor's own images of the last moments.
#include "apps/cli/run/reference_images.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <chrono>

namespace eventide::app {

namespace {

/// 8-bit BGR or grey, for which colours are weighed as cvtColor does.
cv::Mat shown_of(const ReferenceImage& image, ReferenceImages::Shows shows) {
    using Shows = ReferenceImages::Shows;
    const int width = image.pixels.width() / image.channels;
    const cv::Mat wide(image.pixels.height(), width, CV_MAKETYPE(CV_16U, image.channels),
                       const_cast<std::uint16_t*>(image.pixels.values().data()));
    cv::Mat narrow, changed;
    wide.convertTo(narrow, CV_8U, 1.0 / 257);
    const bool has_alpha = image.channels == 4;
    if (image.channels == 1 || (shows == Shows::colours && !has_alpha)) return narrow;
    cv::cvtColor(narrow, changed,
                 shows == Shows::colours ? cv::COLOR_BGRA2BGR
                 : has_alpha             ? cv::COLOR_BGRA2GRAY
                                         : cv::COLOR_BGR2GRAY);
    return changed;
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
        draw(images_[*image], sensor, Shows::grey, shown);
}

void ReferenceImages::draw_nearest(SensorTime t, const Window& window, cv::Size sensor, Shows shows,
                                   cv::Mat& shown) const {
    const std::lock_guard lock{mutex_};
    const auto image = nearest_to(t);
    if (image &&
        2 * std::chrono::abs(images_[*image].t - t) <= std::max(window.width(), spacing_at(*image)))
        draw(images_[*image], sensor, shows, shown);
}

void ReferenceImages::draw(const ReferenceImage& image, cv::Size sensor, Shows shows,
                           cv::Mat& shown) const {
    const cv::Mat all = shown_of(image, shows);
    shown = cv::Mat::zeros(sensor, all.type());
    const cv::Rect whole{{0, 0}, sensor};
    const cv::Rect place = cv::Rect{image.x0, image.y0, all.cols, all.rows} & whole;
    if (place.empty()) return;  // nothing of it lies on the sensor
    all(place - cv::Point{image.x0, image.y0}).copyTo(shown(place));
}

}  // namespace eventide::app
