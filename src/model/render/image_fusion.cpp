// A camera's own images beside its events.
#include "src/model/render/image_fusion.h"

#include "src/core/grey.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace eventide {
namespace {

// Each slot of the past takes at least this long: 12 of them reach back 200 ms and more.
// 11 whole ones, 200.2 ms, beside the one that is being filled.
constexpr SensorDuration kPastSlot{18'200};
// Standard deviation of a camera's own images.
constexpr float kImageNoise = .02F;

/// Where row or column `out` of a frame lies on the sensor (docs/model.md: corners lie on corners).
LinearTap tap(int out, int out_size, int size) {
    const double at = out_size > 1 ? double(out) * (size - 1) / (out_size - 1) : 0;
    const int first = int(at);
    return {first, std::min(first + 1, size - 1), float(at - first)};
}

}  // namespace

ImageFusion::ImageFusion(int sensor_width, int sensor_height)
    : width_(sensor_width), height_(sensor_height), pyramid_(sensor_width, sensor_height) {
    for (Expected& expected : expected_) {
        expected.correction = Array2<float>(height_, width_);
        expected.variance = Array2<float>(height_, width_);
    }
    for (Past& past : past_) past.events = Array2<float>(height_, width_);
    row_.resize(std::size_t(width_));
    for (Array2<float>* map : {&residual_, &trust_, &since_}) *map = Array2<float>(height_, width_);
    reset();
}

void ImageFusion::reset() noexcept {
    pyramid_.reset();
    windows_ = 0;
    for (Expected& expected : expected_) {
        expected.window = {};
        fill(expected.correction, 0);
        fill(expected.variance, 1);
    }
    for (Past& past : past_) past.window = {};
}

void ImageFusion::advance(const Window& window, const Array2<float>& events) noexcept {
    ++windows_;
    newest().window = window;
    pyramid_.forget(events);
    remember(window, events);
    pyramid_.expect(newest().correction, newest().variance);
}

void ImageFusion::remember(const Window& window, const Array2<float>& events) noexcept {
    if (past_[past_newest_].window.width() >= kPastSlot || windows_ == 1) {
        past_newest_ = (past_newest_ + 1) % past_.size();
        past_[past_newest_].window = {window.begin, window.begin};
        fill(past_[past_newest_].events, 0);
    }
    Past& past = past_[past_newest_];
    past.window.end = window.end;
    for (std::size_t i = 0; i < past.events.values().size(); ++i)
        past.events.values()[i] += events.values()[i];
}

/// Events per pixel since t, as if each slot's had come evenly.
void ImageFusion::collect_since(SensorTime t) noexcept {
    fill(since_, 0);
    for (const Past& past : past_) {
        const double width = double(past.window.width().count());
        if (width <= 0 || past.window.end <= t) continue;
        const float share = float(std::min(1., double((past.window.end - t).count()) / width));
        for (std::size_t i = 0; i < since_.values().size(); ++i)
            since_.values()[i] += share * past.events.values()[i];
    }
}

bool ImageFusion::correct(const ReferenceImage& image, const Frame& rendered) noexcept {
    Expected& now = newest();
    if (windows_ == 0 || image.t > now.window.end || image.t < now.window.end - kRemembered)
        return false;
    // Things that move while the shutter is open are as blurred as if they had moved since.
    collect_since(std::min(image.t, image.exposure_begin));
    std::ranges::copy(now.correction.values(), residual_.values().begin());
    fill(trust_, 0);
    const int columns = image.pixels.width() / image.channels;
    // Image pixel (y, x) is sensor pixel (y + y0, x + x0), as far as there is one.
    for (int y = std::max(0, -image.y0); y < std::min(image.pixels.height(), height_ - image.y0);
         ++y)
        for (int x = std::max(0, -image.x0); x < std::min(columns, width_ - image.x0); ++x) {
            const float seen = grey_at(image, y, x);
            const int v = y + image.y0, u = x + image.x0;
            const float shown = rendered.intensity(v, u);
            // A residual is image - mu; where the image tells nothing, what is expected already.
            const float before = shown + residual_(v, u);
            // Beyond the ends of the image's range the truth is at least as dark or bright.
            const bool beyond =
                (seen >= kBrightest && before >= seen) || (seen <= kDarkest && before <= seen);
            if (beyond) continue;
            residual_(v, u) = seen - shown;
            trust_(v, u) = 1;
        }
    pyramid_.observe(residual_, trust_, since_);
    pyramid_.expect(now.correction, now.variance);
    return true;
}

const ImageFusion::Expected& ImageFusion::at_end_of(std::uint64_t window) const {
    return expected_[std::size_t(window % expected_.size())];
}

void ImageFusion::prepare(const RenderRequest& request) {
    const int out_width = request.width > 0 ? request.width : width_;
    const Region& region = request.region;
    const int columns = region.width > 0 ? region.width : out_width - region.x;
    if (out_width_ == out_width && first_column_ == region.x && int(columns_.size()) == columns)
        return;
    columns_.resize(std::size_t(columns));
    for (int x = 0; x < columns; ++x)
        columns_[std::size_t(x)] = tap(x + region.x, out_width, width_);
    out_width_ = out_width;
    first_column_ = region.x;
}

/// One row of a map as it is between two windows' ends, at the sensor's columns.
void ImageFusion::mix_row(const Array2<float>& before, const Array2<float>& after, float at,
                          const LinearTap& y, std::vector<float>& row) noexcept {
    const auto a = before.row(y.first), b = before.row(y.second);
    const auto c = after.row(y.first), d = after.row(y.second);
    for (std::size_t x = 0; x < row.size(); ++x) {
        const float old = a[x] + y.weight * (b[x] - a[x]), now = c[x] + y.weight * (d[x] - c[x]);
        row[x] = old + at * (now - old);
    }
}

/// intensity += correction, sigma^2 = v sigma^2 + (1 - v) .02^2 with v = variance: both linear in
/// time between the ends of two windows, and in place between the sensor's pixels.
void ImageFusion::apply(const RenderRequest& request, Frame& frame) noexcept {
    assert(frame.intensity.width() == int(columns_.size()));
    std::uint64_t k = windows_;
    // The window that the frame is in: the newest or one of the two before it.
    while (k > 1 && k + 2 > windows_ && frame.t <= at_end_of(k).window.begin) --k;
    const Expected &after = at_end_of(k), &before = at_end_of(k - 1);
    const double width = double(after.window.width().count());
    const double since = double((frame.t - after.window.begin).count());
    const float at = width > 0 ? float(std::clamp(since / width, 0., 1.)) : 1.F;
    const int out_height = request.height > 0 ? request.height : height_;
    const auto sample = [&](const std::vector<float>& row, const LinearTap& x) {
        const float first = row[std::size_t(x.first)];
        return first + x.weight * (row[std::size_t(x.second)] - first);
    };
    for (int y = 0; y < frame.intensity.height(); ++y) {
        const LinearTap v = tap(y + request.region.y, out_height, height_);
        mix_row(before.correction, after.correction, at, v, row_);
        const auto intensity = frame.intensity.row(y);
        for (std::size_t x = 0; x < columns_.size(); ++x) intensity[x] += sample(row_, columns_[x]);
        if (frame.sigma.empty()) continue;
        mix_row(before.variance, after.variance, at, v, row_);
        const auto sigma = frame.sigma.row(y);
        for (std::size_t x = 0; x < columns_.size(); ++x) {
            const float left = sample(row_, columns_[x]);
            sigma[x] =
                std::sqrt(left * sigma[x] * sigma[x] + (1 - left) * kImageNoise * kImageNoise);
        }
    }
}

}  // namespace eventide
