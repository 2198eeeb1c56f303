// Leaves out the events of pixels that fire by themselves.
#pragma once

#include "pipeline/stages.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace eventide {

/// Bin thread. Deterministic: what is left out depends on the events, not on how they are split.
///
/// Learning: at the end of each interval of sensor time a pixel becomes hot when it fired at least
/// kHotHz and kTimesNeighbours times as often as the median of the pixels around it (5 x 5): a
/// moving edge makes whole neighbourhoods fire, a hot pixel stands alone. It stays hot until it
/// fires at less than half of kHotHz.
class HotPixelFilter : public EventFilter {
public:
    static constexpr SensorDuration kInterval{250'000};
    static constexpr double kHotHz = 60;
    static constexpr std::uint32_t kTimesNeighbours = 10;

    /// Learns while it works, on a sensor of width x height px.
    HotPixelFilter(int width, int height);

    /// Leaves out the pixels a text file names, one "x,y" (or "x y") a line; # begins a comment.
    /// Throws Error (usage) naming the line that is not, or lies outside the sensor.
    HotPixelFilter(int width, int height, const std::filesystem::path& list);

    void process(std::vector<Event>& events) override;

    /// How many pixels are hot now. Bin thread.
    std::size_t hot_pixels() const;

private:
    std::size_t pixel_of(const Event& event) const {
        return std::size_t(event.y) * std::size_t(width_) + event.x;
    }
    void end_interval();
    std::uint32_t median_around(int y, int x) const;

    int width_, height_;
    bool learns_;
    std::vector<std::uint32_t> counts_;  // [y][x], of this interval
    std::vector<std::uint8_t> hot_;      // [y][x]
    std::optional<SensorTime> interval_end_;
};

}  // namespace eventide
