// When the open event window has seen enough: counted per tile, so that a burst on a part of the
// sensor ends it as well as motion everywhere.
#pragma once

#include "src/core/event.h"

#include <cstdint>
#include <vector>

namespace eventide {

/// Counts events per tile of kSide x kSide px. Busy once a sixteenth of the tiles (two at least,
/// where there are two: one may hold a hot pixel) have `events_per_pixel` of their own pixels each.
class TileActivity {
public:
    static constexpr int kSide = 32;

    TileActivity() = default;
    /// Sensor of width x height px.
    TileActivity(double events_per_pixel, int width, int height);

    /// Whether the sensor is busy with this event. Events outside the sensor count nowhere.
    bool add(const Event& event) noexcept;

    void reset() noexcept;

private:
    int width_ = 0, height_ = 0, columns_ = 0;
    int full_tiles_ = 0, enough_ = 1;
    std::vector<std::uint32_t> count_, full_;  // per tile: events so far, events that fill it
};

}  // namespace eventide
