// Crop, flip, range and sharpness of a frame.
#include "pipeline/sinks/adjust.h"

#include "src/core/error.h"
#include "src/core/frame_stamp.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace eventide {

namespace {

/// Copies the inside of `from`, mirrored as asked.
void crop_and_flip(const Array2<float>& from, int crop, Flip flip, Array2<float>& into) {
    const int height = from.height() - 2 * crop, width = from.width() - 2 * crop;
    if (into.height() != height || into.width() != width) into = Array2<float>{height, width};
    const bool mirror_y = flip == Flip::vertical || flip == Flip::both;
    const bool mirror_x = flip == Flip::horizontal || flip == Flip::both;
    for (int y = 0; y < height; ++y) {
        const auto source =
            from.row(crop + (mirror_y ? height - 1 - y : y)).subspan(std::size_t(crop));
        const auto inside = source.first(std::size_t(width));
        const auto target = into.row(y);
        if (mirror_x)
            std::reverse_copy(inside.begin(), inside.end(), target.begin());
        else
            std::ranges::copy(inside, target.begin());
    }
}

/// The values that leave the shares kBelow and kAbove outside, to 1/1024 of intensity.
AutoRange::Range percentiles(const Array2<float>& intensity) {
    constexpr float kFirst = -1.0f, kLast = 2.0f;
    constexpr std::size_t kBins = 3 * 1024;
    constexpr float kWidth = (kLast - kFirst) / float(kBins);
    std::array<std::uint32_t, kBins> histogram{};
    for (const float v : intensity.values()) {
        if (std::isnan(v)) continue;
        const float bin = std::clamp((v - kFirst) / kWidth, 0.0f, float(kBins - 1));
        ++histogram[std::size_t(bin)];
    }
    const auto pixels = double(intensity.values().size());
    const auto value = [&](std::size_t bin) { return kFirst + (float(bin) + 0.5f) * kWidth; };
    std::size_t low = 0, high = kBins - 1;
    for (double below = histogram[0]; low < high && below <= AutoRange::kBelow * pixels;)
        below += histogram[++low];
    for (double above = histogram[high]; high > low && above <= AutoRange::kAbove * pixels;)
        above += histogram[--high];
    return {value(low), value(high)};
}

}  // namespace

std::string_view name_of(Flip flip) {
    switch (flip) {
        case Flip::horizontal:
            return "horizontal";
        case Flip::vertical:
            return "vertical";
        case Flip::both:
            return "both";
        case Flip::none:
            break;
    }
    return "none";
}

bool AdjustSettings::changes_nothing() const {
    return !auto_hdr && unsharp == 0 && flip == Flip::none && crop_px == 0;
}

AutoRange::Range AutoRange::update(SensorTime t, const Array2<float>& intensity) {
    const Range now = percentiles(intensity);
    double passed = begun_ ? std::chrono::duration<double>(t - last_).count() : 0;
    if (passed < 0) weight_ = passed = 0;  // begins anew
    const double old = std::exp(-passed / kSeconds);
    weight_ = old * weight_ + (1 - old);
    const auto share = float(weight_ > 0 ? (1 - old) / weight_ : 1);
    smooth_.low += share * (now.low - smooth_.low);
    smooth_.high += share * (now.high - smooth_.high);
    last_ = t;
    begun_ = true;
    const float middle = (smooth_.low + smooth_.high) / 2;
    const float half = std::max(smooth_.high - smooth_.low, kNarrowest) / 2;
    return {middle - half, middle + half};
}

const Frame& Adjustment::apply(const Frame& frame) {
    if (2 * settings_.crop_px >= std::min(frame.intensity.height(), frame.intensity.width()))
        throw Error(ErrorKind::usage, "--crop " + std::to_string(settings_.crop_px) +
                                          ": nothing is left of a frame of " +
                                          std::to_string(frame.intensity.width()) + "x" +
                                          std::to_string(frame.intensity.height()));
    copy_stamp(frame, shown_);
    crop_and_flip(frame.intensity, settings_.crop_px, settings_.flip, shown_.intensity);
    if (frame.sigma.empty())
        shown_.sigma = {};
    else
        crop_and_flip(frame.sigma, settings_.crop_px, settings_.flip, shown_.sigma);
    for (std::size_t c = 0; c < frame.colour.size(); ++c)
        if (frame.colour[c].empty())
            shown_.colour[c] = {};
        else
            crop_and_flip(frame.colour[c], settings_.crop_px, settings_.flip, shown_.colour[c]);
    if (frame.event_preview.empty())
        shown_.event_preview = {};
    else
        crop_and_flip(frame.event_preview, 0, settings_.flip, shown_.event_preview);
    if (settings_.auto_hdr) stretch();
    if (settings_.unsharp != 0) sharpen();
    return shown_;
}

void Adjustment::stretch() {
    const AutoRange::Range range = range_.update(shown_.t, shown_.intensity);
    const float gain = 1 / (range.high - range.low);
    for (float& v : shown_.intensity.values()) v = (v - range.low) * gain;
    for (Array2<float>& plane : shown_.colour)
        for (float& v : plane.values()) v = (v - range.low) * gain;
    for (float& v : shown_.sigma.values()) v *= gain;
}

void Adjustment::sharpen() {
    const auto sharpen = [&](Array2<float>& plane) {
        cv::Mat image(plane.height(), plane.width(), CV_32FC1, plane.values().data());
        cv::Mat blurred;
        cv::GaussianBlur(image, blurred, {0, 0}, 1.0);
        cv::addWeighted(image, 1 + double(settings_.unsharp), blurred, -double(settings_.unsharp),
                        0, image);
    };
    sharpen(shown_.intensity);
    for (Array2<float>& plane : shown_.colour)
        if (!plane.empty()) sharpen(plane);
}

AdjustSink::AdjustSink(AdjustSettings settings, std::vector<std::unique_ptr<Sink>> behind)
    : ChangingSink{std::move(behind)}, adjust_{settings} {}

}  // namespace eventide
