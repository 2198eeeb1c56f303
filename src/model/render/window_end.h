// What an event window shows at its end. Where the live edge fades, every frame of the next window
// begins with it, so it is computed once for all of them.
#pragma once

#include "src/model/render/sampling.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace eventide {

/// mu and ln sigma of a frame's pixels, of one event window's samples alone; tile by tile, each of
/// its own event window. Frames of which these two maps take more than kMaxBytes are not kept.
class WindowEnd {
public:
    static constexpr std::size_t kMaxBytes = std::size_t{16} << 20;

    /// Nothing is kept of frames of another size.
    void make_room(const FrameGeometry& geometry, std::size_t tiles) {
        const std::size_t width = std::size_t(geometry.part_width),
                          pixels = width * std::size_t(geometry.part_height);
        width_ = width;
        is_kept_ = 2 * pixels * sizeof(float) <= kMaxBytes;
        if (!is_kept_) return;
        mu_.resize(pixels);
        log_sigma_.resize(pixels);
        window_.assign(tiles, 0);
    }
    void reset() noexcept { std::ranges::fill(window_, 0); }

    bool is_kept() const { return is_kept_; }
    /// Whether the tile's pixels are those of event window k.
    bool holds(std::size_t tile, std::int64_t k) const { return window_[tile] == k; }
    void note(std::size_t tile, std::int64_t k) { window_[tile] = k; }

    float* mu(int row) { return mu_.data() + std::size_t(row) * width_; }
    float* log_sigma(int row) { return log_sigma_.data() + std::size_t(row) * width_; }

private:
    std::size_t width_ = 0;
    bool is_kept_ = false;
    std::vector<float> mu_, log_sigma_;
    std::vector<std::int64_t> window_;  // per tile; 0: none
};

}  // namespace eventide
