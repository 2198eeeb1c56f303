// When the open event window has seen enough: counted per tile, so that a burst on a part of the
// sensor ends it as well as motion everywhere.
#pragma once

#include "src/core/event.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace eventide {

/// Counts events per tile of kSide x kSide px, of each pixel no more than kMostOfAPixel: a contour
/// of high contrast gives many where it passes, and moves no further for that. Busy once a
/// sixteenth of the tiles (two at least, where there are two: one of a few pixels, at the sensor's
/// edge, may be full of a hot one) have `events_per_pixel` of their own pixels each.
class TileActivity {
public:
    static constexpr int kSide = 32;
    static constexpr int kMostOfAPixel = 2;

    TileActivity() = default;
    /// Sensor of width x height px.
    TileActivity(double events_per_pixel, int width, int height);

    /// The time of the event with which the sensor became busy; empty: not yet. `window`: the
    /// events of the open event window, of which those of the calls before are not counted again.
    /// Events outside the sensor count nowhere.
    std::optional<SensorTime> busy_at(std::span<const Event> window) noexcept;

    void reset() noexcept;  ///< another event window is open

private:
    bool add(const Event& event) noexcept;

    int width_ = 0, height_ = 0, columns_ = 0;
    int full_tiles_ = 0, enough_ = 1;
    std::vector<std::uint8_t> of_pixel_;       // [y][x]: events so far, up to kMostOfAPixel
    std::vector<std::uint32_t> count_, full_;  // per tile: events so far, events that fill it
    std::size_t counted_ = 0;                  // of the window's events
    std::optional<SensorTime> busy_at_;
};

}  // namespace eventide
