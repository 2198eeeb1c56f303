// Counts per tile.
#include "src/binning/tile_activity.h"

#include <algorithm>
#include <cmath>

namespace eventide {

TileActivity::TileActivity(double events_per_pixel, int width, int height)
    : width_(width), height_(height), columns_((width + kSide - 1) / kSide) {
    for (int y = 0; y < height; y += kSide)
        for (int x = 0; x < width; x += kSide) {
            const int pixels = std::min(kSide, height - y) * std::min(kSide, width - x);
            full_.push_back(std::uint32_t(std::max(1.0, std::ceil(events_per_pixel * pixels))));
        }
    count_.resize(full_.size());
    of_pixel_.resize(std::size_t(width) * std::size_t(height));
    const int tiles = int(full_.size());
    enough_ = std::min(tiles, std::max(2, tiles / 16));
}

std::optional<SensorTime> TileActivity::busy_at(std::span<const Event> window) noexcept {
    for (; !busy_at_ && counted_ < window.size(); ++counted_)
        if (add(window[counted_])) busy_at_ = window[counted_].t;
    return busy_at_;
}

/// Whether the sensor is busy with this event.
bool TileActivity::add(const Event& event) noexcept {
    if (event.x >= width_ || event.y >= height_) return false;
    std::uint8_t& of_pixel = of_pixel_[std::size_t(event.y) * std::size_t(width_) + event.x];
    if (of_pixel == kMostOfAPixel) return false;
    ++of_pixel;
    const auto tile = std::size_t(event.y / kSide * columns_ + event.x / kSide);
    if (++count_[tile] == full_[tile]) ++full_tiles_;
    return full_tiles_ >= enough_;
}

void TileActivity::reset() noexcept {
    std::ranges::fill(count_, 0U);
    std::ranges::fill(of_pixel_, std::uint8_t{0});
    full_tiles_ = 0;
    counted_ = 0;
    busy_at_.reset();
}

}  // namespace eventide
