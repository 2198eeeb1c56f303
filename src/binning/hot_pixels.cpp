// Finds the pixels of an event sensor that fire by themselves.
#include "src/binning/hot_pixels.h"

#include "src/core/error.h"

#include <algorithm>
#include <chrono>
#include <string>

namespace eventide {

HotPixels::HotPixels(int width, int height, double hz, SensorDuration interval)
    : width_{width},
      height_{height},
      hot_count_(std::uint32_t(hz * std::chrono::duration<double>(interval).count())),
      interval_{interval},
      pixels_(std::size_t(width) * std::size_t(height)) {}

std::size_t HotPixels::count() const {
    return std::size_t(
        std::ranges::count_if(pixels_, [](const Pixel& pixel) { return pixel.hot; }));
}

void HotPixels::reset() noexcept {
    std::ranges::fill(pixels_, Pixel{});
    interval_end_.reset();
    last_ = SensorTime::min();
}

HotPixels::State HotPixels::state() const {
    State state{{}, {}, interval_end_};
    for (const Pixel& pixel : pixels_) {
        state.events.push_back(pixel.events);
        state.hot.push_back(pixel.hot ? 1 : 0);
    }
    return state;
}

void HotPixels::restore(const State& state) {
    if (state.events.size() != pixels_.size() || state.hot.size() != pixels_.size())
        throw Error(ErrorKind::input, "hot pixels: expected the state of " +
                                          std::to_string(pixels_.size()) + " pixels, found " +
                                          std::to_string(state.events.size()) + " and " +
                                          std::to_string(state.hot.size()));
    for (std::size_t i = 0; i < pixels_.size(); ++i) {
        pixels_[i].events = state.events[i] & 0x7FFF'FFFF;
        pixels_[i].hot = state.hot[i] != 0;
    }
    interval_end_ = state.interval_end;
    last_ = SensorTime::min();
}

void HotPixels::renew(SensorTime t) noexcept {
    // Of a clock that was reset an old end may never come, and what was counted is of another time.
    if (!interval_end_ || t < last_) {
        for (Pixel& pixel : pixels_) pixel.events = 0;
        interval_end_ = t + interval_;
    }
    if (t < *interval_end_) return;
    end_interval();
    // Intervals without any event change nothing a second time: one step over them.
    if (t >= *interval_end_) {
        end_interval();
        interval_end_ = t + interval_;
    }
}

void HotPixels::end_interval() noexcept {
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            Pixel& pixel = pixels_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
            if (pixel.hot)
                pixel.hot = pixel.events >= hot_count_ / 2;
            else if (pixel.events >= hot_count_)
                pixel.hot = pixel.events >= kTimesNeighbours * second_busiest_around(y, x);
        }
    for (Pixel& pixel : pixels_) pixel.events = 0;
    *interval_end_ += interval_;
}

std::uint32_t HotPixels::second_busiest_around(int y, int x) const noexcept {
    std::uint32_t first = 0, second = 0;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height_ - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width_ - 1); ++u) {
            if (v == y && u == x) continue;
            const std::uint32_t n =
                pixels_[std::size_t(v) * std::size_t(width_) + std::size_t(u)].events;
            second = std::max(second, std::min(first, n));
            first = std::max(first, n);
        }
    return second;
}

}  // namespace eventide
