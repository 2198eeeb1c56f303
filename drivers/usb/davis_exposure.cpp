#include "drivers/usb/davis_exposure.h"

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

constexpr double kWantedMean = 0.4;    // of full scale, linear in light
constexpr double kCloseEnough = 0.15;  // relative: no hunting
constexpr double kMaxSaturated = 0.3;  // share of white pixels past which the mean says nothing
constexpr int kShortestUs = 10, kLongestUs = 200'000;

}  // namespace

int better_exposure_us(const ReferenceImage& frame, int current_us) {
    const auto pixels = frame.pixels.values();
    if (pixels.empty()) return current_us;
    double sum = 0;
    std::size_t white = 0;
    for (const std::uint16_t p : pixels) {
        sum += p;
        white += p == 65535 ? 1 : 0;
    }
    const double mean = sum / (65535.0 * double(pixels.size()));
    double factor = kWantedMean / std::max(mean, 1e-3);
    if (double(white) > kMaxSaturated * double(pixels.size())) factor = 0.25;
    if (std::abs(factor - 1) < kCloseEnough) return current_us;
    factor = std::clamp(factor, 0.25, 2.0);
    return std::clamp(int(std::lround(std::max(current_us, kShortestUs) * factor)), kShortestUs,
                      kLongestUs);
}

void ExposingDavisParser::parse(std::span<const std::byte> bytes, Batch& into) {
    const std::size_t before = into.images.size();
    parser_.parse(bytes, into);
    for (std::size_t i = before; i < into.images.size(); ++i) {
        if (wait_frames_ > 0) {
            --wait_frames_;
            continue;
        }
        const int request = better_exposure_us(into.images[i], exposure_us_);
        if (request == exposure_us_) continue;
        exposure_us_ = request;
        wait_frames_ = kFramesUntilItShows;
        request_->store(request, std::memory_order_relaxed);
    }
}

}  // namespace eventide
