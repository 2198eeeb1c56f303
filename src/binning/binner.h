// event window -> voxel grid (docs/model.md, "Input").
#pragma once

#include "src/core/array.h"
#include "src/core/frame_data.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace eventide {

/// Sums exact integers and divides once, so the grid does not depend on the order of the events, on
/// how they were split, or on the size of the absolute time; the standard deviation of equal
/// timestamps is exactly 0.
///
/// A window of width W us has B bins; in ticks of 1/B us each bin is exactly W ticks wide, so bins
/// need no rounding for any B: an event dt us after the window's begin is in bin b = (dt B - 1) /
/// W, d = dt B - b W ticks (1 to W) after the bin's begin, and f = d / W. Where W > 2^19 us, d
/// loses its lowest bits so that it stays below 2^19: sums of squares then hold 2^26 events per
/// pixel and bin, and f is right to 2^-19.
class Binner {
public:
    /// Throws Error (usage) unless all are at least 1.
    Binner(int bins, int height, int width);

    VoxelGrid make_output() const;  ///< values of [height][width][4 bins + 1], touched, ages

    /// `grid` is one from make_output(), in which nothing but process() has written since: only
    /// what differs from its last window is cleared. Events outside the sensor or the window are
    /// left out.
    void process(const EventWindow& event_window, VoxelGrid& grid) noexcept;

    /// As constructed: no pixel has had an event.
    void reset() noexcept;

    int bins() const { return bins_; }

    /// [y][x]: event windows since each pixel's last event; all it knows of those before.
    const std::vector<std::uint8_t>& ages() const { return ages_; }
    /// Throws Error (input) for ages of another sensor, and is then as it was. What is older than
    /// counts is as old as counts.
    void restore(const std::vector<std::uint8_t>& ages);

private:
    /// Sums over one pixel's events in the bin at hand.
    struct Moments {
        std::uint64_t counts = 0;   ///< low half: events; high half: sum of polarities, signed
        std::uint64_t sum = 0;      ///< of d
        std::uint64_t squares = 0;  ///< of d
    };
    /// How the ticks of one bin follow from an event's time.
    struct BinTicks {
        std::int64_t first_dt, last_dt;  ///< us after the window's begin, inclusive
        std::int64_t origin;             ///< b W
        int shift;
    };
    BinTicks ticks_of(int bin, std::int64_t width_us) const;
    void add(std::span<const Event> events, SensorTime begin, const BinTicks& bin) noexcept;
    void write(int bin, double ticks_per_bin, VoxelGrid& grid) noexcept;
    void clear(VoxelGrid& grid) noexcept;
    void clear_all(std::size_t begin, std::size_t end, VoxelGrid& grid) const noexcept;
    void clear_differing(std::size_t begin, std::size_t end, VoxelGrid& grid) const noexcept;
    void set_age(std::size_t pixel, VoxelGrid& grid) const noexcept;

    int bins_, height_, width_;
    // [y][x]; all zero between bins. One bin at a time is summed: of small sensors this stays in
    // the second-level cache.
    std::vector<Moments, HugePageAllocator<Moments>> moments_;
    std::vector<std::uint64_t> touched_;  // a bit per pixel with events in this bin
    std::vector<std::uint8_t> ages_;      // [y][x], windows since the last event, at most kOldest
};

}  // namespace eventide
