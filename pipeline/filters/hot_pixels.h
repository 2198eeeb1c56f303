// Leaves out the events of pixels that fire by themselves.
#pragma once

#include "pipeline/stages.h"
#include "src/binning/hot_pixels.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace eventide {

/// Bin thread.
class HotPixelFilter : public EventFilter {
public:
    /// Hot from here on, in a quarter of a second (HotPixels).
    static constexpr double kHotHz = 60;

    /// Learns while it works, on a sensor of width x height px.
    HotPixelFilter(int width, int height);

    /// Leaves out the pixels a text file names, one "x,y" (or "x y") a line; # begins a comment.
    /// Throws Error (usage) naming the line that is not, or lies outside the sensor.
    HotPixelFilter(int width, int height, const std::filesystem::path& list);

    void process(std::vector<Event>& events) override;

    /// How many pixels are hot now. Bin thread.
    std::size_t hot_pixels() const;

private:
    int width_;
    std::optional<HotPixels> learned_;  // without a list
    std::vector<std::uint8_t> listed_;  // [y][x]
};

}  // namespace eventide
