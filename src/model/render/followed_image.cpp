// The last image of the camera, displaced to where things are now.
#include "src/model/render/followed_image.h"

#include "src/core/grey.h"
#include "src/model/render/half_maps.h"

#include <algorithm>
#include <array>

namespace eventide {
namespace {

// Where what the model shows and what it showed, displaced, differ by this, the image counts half.
constexpr float kMismatch = .1F;

}  // namespace

void add_motion_row(const MotionField& motion, int y, float times, std::span<float> dx,
                    std::span<float> dy) noexcept {
    add_doubled_row(motion.dx, y, dx, times);
    add_doubled_row(motion.dy, y, dy, times);
}

void displaced_row(const Array2<float>& map, int y, std::span<const float> dx,
                   std::span<const float> dy, std::span<float> row) noexcept {
    const auto none = [](std::span<const float> d) {
        return std::ranges::all_of(d, [](float v) { return v == 0; });
    };
    if (none(dx) && none(dy)) {
        std::ranges::copy(map.row(y), row.begin());
        return;
    }
    // Where to read, what is there, and what lies between, each for a stretch: only reading goes
    // pixel by pixel. The last pixel of a row or column is read as the second of two.
    constexpr std::size_t kStretch = 64;
    std::array<int, kStretch> at;
    std::array<float, kStretch> across, along, upper_left, upper_right, lower_left, lower_right;
    const int last_y = map.height() - 1, last_x = map.width() - 1, width = map.width();
    const int last_upper = std::max(0, last_y - 1), last_left = std::max(0, last_x - 1);
    const int right = last_x > 0 ? 1 : 0, below = last_y > 0 ? width : 0;
    const float* const pixels = map.values().data();
    for (std::size_t begin = 0; begin < row.size(); begin += kStretch) {
        const std::size_t count = std::min(kStretch, row.size() - begin);
        for (std::size_t i = 0; i < count; ++i) {
            const float v = std::clamp(float(y) + dy[begin + i], 0.F, float(last_y));
            const float u = std::clamp(float(int(begin + i)) + dx[begin + i], 0.F, float(last_x));
            const int y0 = std::min(int(v), last_upper), x0 = std::min(int(u), last_left);
            at[i] = y0 * width + x0;
            along[i] = v - float(y0);
            across[i] = u - float(x0);
        }
        for (std::size_t i = 0; i < count; ++i) {
            const float* const upper = pixels + at[i];
            upper_left[i] = upper[0];
            upper_right[i] = upper[right];
            lower_left[i] = upper[below];
            lower_right[i] = upper[below + right];
        }
        for (std::size_t i = 0; i < count; ++i)
            row[begin + i] = mix(mix(upper_left[i], upper_right[i], across[i]),
                                 mix(lower_left[i], lower_right[i], across[i]), along[i]);
    }
}

FollowedImage::FollowedImage(int sensor_width, int sensor_height)
    : width_(sensor_width),
      height_(sensor_height),
      flow_(sensor_width, sensor_height),
      motion_(sensor_width, sensor_height) {
    for (Array2<float>* map : {&image_, &then_, &covered_, &events_})
        *map = Array2<float>(height_, width_);
    for (std::vector<float>* row : {&dx_, &dy_, &row_}) row->resize(std::size_t(width_));
}

void FollowedImage::reset() noexcept {
    there_ = covers_all_ = false;
    fill(covered_, 0);
}

void FollowedImage::take(const ReferenceImage& image, const Array2<float>& shown,
                         const Array2<float>& correction, const Array2<float>& since,
                         Array2<float>& trust) noexcept {
    copy(shown, then_);
    copy(since, events_);
    for (std::size_t i = 0; i < image_.values().size(); ++i)
        image_.values()[i] = shown.values()[i] + correction.values()[i];
    fill(trust, 0);
    const int columns = image.pixels.width() / image.channels;
    // Image pixel (y, x) is sensor pixel (y + y0, x + x0), as far as there is one.
    for (int y = std::max(0, -image.y0); y < std::min(image.pixels.height(), height_ - image.y0);
         ++y)
        for (int x = std::max(0, -image.x0); x < std::min(columns, width_ - image.x0); ++x) {
            const float seen = grey_at(image, y, x);
            const int v = y + image.y0, u = x + image.x0;
            covered_(v, u) = 1;
            // Beyond the ends of the image's range the truth is at least as dark or bright.
            const float before = image_(v, u);
            const bool beyond =
                (seen >= kBrightest && before >= seen) || (seen <= kDarkest && before <= seen);
            if (beyond) continue;
            image_(v, u) = seen;
            trust(v, u) = 1;
        }
    covers_all_ = std::ranges::all_of(covered_.values(), [](float c) { return c == 1; });
    there_ = true;
}

void FollowedImage::pass(const Array2<float>& events) noexcept {
    for (std::size_t i = 0; i < events_.values().size(); ++i)
        events_.values()[i] += events.values()[i];
}

void FollowedImage::follow(const Array2<float>& shown) noexcept {
    fill(motion_.dx, 0);
    fill(motion_.dy, 0);
    flow_.find(shown, then_, events_, motion_);
}

void FollowedImage::follow(const Array2<float>& shown, MotionField& since_before) noexcept {
    copy(motion_.dx, since_before.dx);
    copy(motion_.dy, since_before.dy);
    flow_.find(shown, then_, events_, motion_);
    const auto less = [](const Array2<float>& now, Array2<float>& before) {
        for (std::size_t i = 0; i < before.values().size(); ++i)
            before.values()[i] = now.values()[i] - before.values()[i];
    };
    less(motion_.dx, since_before.dx);
    less(motion_.dy, since_before.dy);
}

void FollowedImage::tell_trust(Array2<float>& trust) noexcept {
    for (int y = 0; y < height_; ++y) {
        for (std::vector<float>* row : {&dx_, &dy_, &row_}) std::ranges::fill(*row, 0);
        add_motion_row(motion_, y, 1, dx_, dy_);
        add_doubled_row(flow_.mismatch(), y, row_);
        const auto out = trust.row(y);
        for (std::size_t x = 0; x < out.size(); ++x) {
            const float v = float(y) + dy_[x], u = float(x) + dx_[x], off = row_[x] / kMismatch;
            // A pixel beyond the edge is as good as the edge.
            const bool inside =
                v > -1.5F && u > -1.5F && v < float(height_) + .5F && u < float(width_) + .5F;
            out[x] = inside ? 1 / (1 + off * off) : 0;
        }
    }
}

void FollowedImage::residual(const Array2<float>& shown, const MotionField& since_before,
                             float back, Array2<float>& residual) noexcept {
    for (int y = 0; y < height_; ++y) {
        for (std::vector<float>* row : {&dx_, &dy_}) std::ranges::fill(*row, 0);
        add_motion_row(motion_, y, 1, dx_, dy_);
        if (back != 0) add_motion_row(since_before, y, -back, dx_, dy_);
        const auto out = residual.row(y);
        const auto there = shown.row(y);
        displaced_row(image_, y, dx_, dy_, out);
        for (std::size_t x = 0; x < out.size(); ++x) out[x] -= there[x];
        if (covers_all_) continue;
        displaced_row(covered_, y, dx_, dy_, row_);
        for (std::size_t x = 0; x < out.size(); ++x) out[x] *= row_[x];
    }
}

}  // namespace eventide
