// A camera's own images beside its events.
#include "src/model/render/image_fusion.h"

#include "src/model/render/half_maps.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace eventide {
namespace {

// Standard deviation of a camera's own images.
constexpr float kImageNoise = .02F;
// Events of what was followed count so much, against those of what was not.
constexpr float kFollowed = .1F;
// A shutter that is said to have been open for longer (a damaged time) was open for this.
constexpr SensorDuration kLongestExposure{10'000'000};
// Share of its window over which an image comes in at least, and over which motion is measured.
constexpr float kFastest = .25F;
/// Where row or column `out` of a frame lies on the sensor (docs/model.md: corners lie on corners).
LinearTap tap(int out, int out_size, int size) {
    const double at = out_size > 1 ? double(out) * (size - 1) / (out_size - 1) : 0;
    const int first = int(at);
    return {first, std::min(first + 1, size - 1), float(at - first)};
}

void copy(const MotionField& from, MotionField& to) noexcept {
    copy(from.dx, to.dx);
    copy(from.dy, to.dy);
}

}  // namespace

ImageFusion::ImageFusion(int sensor_width, int sensor_height)
    : width_(sensor_width),
      height_(sensor_height),
      pyramid_(sensor_width, sensor_height),
      image_(sensor_width, sensor_height),
      past_(sensor_width, sensor_height) {
    for (Expected& expected : expected_) {
        expected.correction = Array2<float>(height_, width_);
        expected.variance = Array2<float>(height_, width_);
        expected.since_before = expected.through = MotionField(width_, height_);
    }
    for (Array2<float>* map :
         {&shown_, &residual_, &trust_, &since_, &residual_within_, &correction_})
        *map = Array2<float>(height_, width_);
    for (std::vector<float>* row : {&row_, &dx_, &dy_}) row->resize(std::size_t(width_));
    reset();
}

void ImageFusion::reset() noexcept {
    pyramid_.reset();
    image_.reset();
    past_.reset();
    fill(residual_, 0);
    windows_ = 0;
    for (Expected& expected : expected_) {
        expected.window = {};
        fill(expected.correction, 0);
        fill(expected.variance, 1);
        expected.followed = expected.new_image = false;
    }
    knows_shown_ = false;
}

void ImageFusion::advance(const Window& window, const Array2<float>& events,
                          const Frame* at_end) noexcept {
    ++windows_;
    Expected& now = newest();
    now.window = window;
    knows_shown_ = at_end != nullptr;
    now.new_image = false;
    now.whole_from = 1;
    past_.remember(window, events);
    if (at_end != nullptr) copy(at_end->intensity, shown_);
    copy(events, since_);
    pass_window();
}

/// Through the newest window, from its begin to its end. since_: its events.
void ImageFusion::pass_window() noexcept {
    Expected& now = newest();
    now.followed = image_.there() && knows_shown_;
    image_.pass(since_);
    for (float& events : since_.values()) events *= now.followed ? kFollowed : 1;
    pyramid_.forget(since_);
    if (now.followed) {
        image_.follow(shown_, now.since_before);
        copy(now.since_before, now.through);
    }
    expect_at_end();
}

/// What is expected at the newest window's end, to which the image has been followed; where it has
/// not, of what was lacking when it was last.
void ImageFusion::expect_at_end() noexcept {
    Expected& now = newest();
    if (now.followed || now.new_image) know(shown_, now.since_before);
    expect(now);
}

/// What is lacking where the image was followed to, and what the model shows there.
void ImageFusion::know(const Array2<float>& shown, const MotionField& since_before) noexcept {
    image_.tell_trust(trust_);
    pyramid_.know(trust_);
    image_.residual(shown, since_before, 0, residual_);
}

void ImageFusion::expect(Expected& expected) noexcept {
    pyramid_.correct(residual_, expected.correction);
    pyramid_.variance(expected.variance);
}

/// An image from before the first window is known at that window's begin, where the model shows
/// `shown`, and followed through it.
void ImageFusion::begin_with(const ReferenceImage& image, const Array2<float>& shown) noexcept {
    Expected& begin = expected_[slot_of(windows_ - 1)];
    fill(since_, 0);
    image_.take(image, shown, begin.correction, since_, trust_);
    pyramid_.observe(trust_, since_);
    image_.follow(shown);
    know(shown, begin.since_before);
    expect(begin);
    past_.add_since(newest().window.begin, 1, since_);
    pass_window();
}

bool ImageFusion::correct(const ReferenceImage& image, const Frame& rendered) noexcept {
    Expected& now = newest();
    if (windows_ == 0 || image.t > now.window.end || image.t < now.window.end - kRemembered)
        return false;
    if (windows_ == 1 && image.t <= now.window.begin) {
        begin_with(image, rendered.intensity);
        return true;
    }
    fill(since_, 0);
    past_.add_since(image.t, 1, since_);
    image_.take(image, rendered.intensity, now.correction, since_, trust_);
    // What moves while the shutter is open is as blurred as if it had moved unfollowed since.
    fill(since_, 0);
    past_.add_since(std::clamp(image.exposure_begin, image.t - kLongestExposure, image.t), 1,
                    since_);
    // What happened before that which is shown was not followed.
    past_.add_since(rendered.t, knows_shown_ ? kFollowed - 1 : 0, since_);
    pyramid_.observe(trust_, since_);
    if (!knows_shown_) copy(rendered.intensity, shown_);
    image_.follow(shown_);
    if (knows_shown_) spread_motion(rendered.t, now);
    come_in(image.t, now);
    expect_at_end();
    return true;
}

/// Since t, when the scene was as an image has it, things are taken to have moved evenly, so that a
/// frame at t shows the image as it is. Of a short time that would say little of the window; the
/// first image has to do so all the same.
void ImageFusion::spread_motion(SensorTime t, Expected& now) noexcept {
    const auto width = double(now.window.width().count());
    const auto since = double((now.window.end - t).count()), shortest = double(kFastest) * width;
    if (now.followed && (t <= now.window.begin || since < shortest)) return;
    const float times = width > 0 ? float(width / std::max(since, shortest)) : 0;
    const auto spread = [times](const Array2<float>& motion, Array2<float>& through) {
        std::ranges::transform(motion.values(), through.values().begin(),
                               [times](float v) { return times * v; });
    };
    spread(image_.motion().dx, now.through.dx);
    spread(image_.motion().dy, now.through.dy);
    if (now.followed) return;
    copy(now.through, now.since_before);
    now.followed = true;
}

/// An image of the window, taken at t. In the first window there was none to go over from.
void ImageFusion::come_in(SensorTime t, Expected& now) const noexcept {
    const double width = double(now.window.width().count());
    const float at = width > 0 ? float(double((t - now.window.begin).count()) / width) : 1;
    if (windows_ > 1)
        now.whole_from = std::max(kFastest, at);
    else if (!now.new_image)
        now.whole_from = at;
    now.new_image = true;
}

const ImageFusion::Expected& ImageFusion::at_end_of(std::uint64_t window) const {
    return expected_[slot_of(window)];
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

namespace {

/// One row of a map as it is between two windows' ends, at the sensor's columns.
void mix_row(const Array2<float>& before, const Array2<float>& after, float at, const LinearTap& y,
             std::vector<float>& row) noexcept {
    const auto a = before.row(y.first), b = before.row(y.second);
    const auto c = after.row(y.first), d = after.row(y.second);
    for (std::size_t x = 0; x < row.size(); ++x) {
        row[x] = mix(mix(a[x], b[x], y.weight), mix(c[x], d[x], y.weight), at);
    }
}

float sample(const std::vector<float>& row, const LinearTap& x) {
    return mix(row[std::size_t(x.first)], row[std::size_t(x.second)], x.weight);
}

}  // namespace

/// What was added at the end of the window before, where it is now: to row_. What is in the window
/// at `at` at x was at x + at d then.
void ImageFusion::row_before(const Expected& before, const Expected& after, float at,
                             int y) noexcept {
    for (std::vector<float>* row : {&dx_, &dy_}) std::ranges::fill(*row, 0);
    if (after.followed) add_motion_row(after.since_before, y, at, dx_, dy_);
    displaced_row(before.correction, y, dx_, dy_, row_);
}

/// Between the ends of a window: what is at x was at x + at d at the end of the one before, and
/// will be at x - (1 - at) d at its own, d as the newest image has it.
void ImageFusion::mix_ends(float at, float weight, const Expected& before,
                           const Expected& after) noexcept {
    for (int y = 0; y < height_; ++y) {
        const auto out = correction_.row(y);
        for (std::vector<float>* row : {&dx_, &dy_}) std::ranges::fill(*row, 0);
        if (after.followed) add_motion_row(after.through, y, at - 1, dx_, dy_);
        displaced_row(after.correction, y, dx_, dy_, out);
        row_before(before, after, at, y);
        for (std::size_t x = 0; x < out.size(); ++x) out[x] = mix(row_[x], out[x], weight);
    }
}

/// Of a frame within a window at `at`, which is 1 at its end. `weight`: of what is known there.
void ImageFusion::correct_within(std::uint64_t window, float at, float weight,
                                 const Array2<float>& shown) noexcept {
    const Expected &after = at_end_of(window), &before = at_end_of(window - 1);
    if (window != windows_ || !after.followed) return mix_ends(at, weight, before, after);
    image_.residual(shown, after.through, 1 - at, residual_within_);
    pyramid_.correct(residual_within_, correction_, at);
    if (!after.new_image) return;
    // The image before is gone, but not what it said at the end of the window before.
    for (int y = 0; y < height_; ++y) {
        const auto out = correction_.row(y);
        row_before(before, after, at, y);
        for (std::size_t x = 0; x < out.size(); ++x) out[x] = mix(row_[x], out[x], weight);
    }
}

/// intensity += correction, sigma^2 = v sigma^2 + (1 - v) .02^2 with v = variance, which is linear
/// in time between the ends of two windows; both linear between the sensor's pixels.
void ImageFusion::apply(const RenderRequest& request, const Array2<float>& shown,
                        Frame& frame) noexcept {
    assert(frame.intensity.width() == int(columns_.size()));
    std::uint64_t k = windows_;
    // The window that the frame is in: the newest or one of the two before it.
    while (k > 1 && k + 2 > windows_ && frame.t <= at_end_of(k).window.begin) --k;
    const Expected &after = at_end_of(k), &before = at_end_of(k - 1);
    const double width = double(after.window.width().count());
    const double since = double((frame.t - after.window.begin).count());
    const float at = width > 0 ? float(std::clamp(since / width, 0., 1.)) : 1.F;
    const float weight = at < after.whole_from ? at / after.whole_from : 1;
    correct_within(k, at, weight, shown);
    const int out_height = request.height > 0 ? request.height : height_;
    for (int y = 0; y < frame.intensity.height(); ++y) {
        const LinearTap v = tap(y + request.region.y, out_height, height_);
        mix_row(correction_, correction_, 0, v, row_);
        const auto intensity = frame.intensity.row(y);
        for (std::size_t x = 0; x < columns_.size(); ++x) intensity[x] += sample(row_, columns_[x]);
        if (frame.sigma.empty()) continue;
        mix_row(before.variance, after.variance, weight, v, row_);
        const auto sigma = frame.sigma.row(y);
        for (std::size_t x = 0; x < columns_.size(); ++x) {
            const float left = sample(row_, columns_[x]);
            sigma[x] =
                std::sqrt(left * sigma[x] * sigma[x] + (1 - left) * kImageNoise * kImageNoise);
        }
    }
}

}  // namespace eventide
