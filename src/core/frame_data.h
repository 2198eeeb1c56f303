// What flows between the stages after the parser: event windows, voxel grids, latent maps, frames.
#pragma once

#include "src/core/array.h"
#include "src/core/event.h"
#include "src/core/sensor_time.h"

#include <eventide/frame.h>

#include <cstdint>
#include <span>
#include <vector>

namespace eventide {

/// The events of one event window, in time order. Borrowed from the slicer until its next call.
struct EventWindow {
    Window window;
    std::span<const Event> events;
    bool gap_before = false;  ///< bytes were lost since the event window before
    HostTime arrived{};       ///< of the last packet that gave an event or moved the clock
    /// The camera's clock was reset: a new stream begins, times may be earlier than before, and
    /// recurrent state means nothing any more.
    bool reset_before = false;
};

/// What is known of an event window beside its events, and travels with all that is made of it.
struct WindowStamp {
    Window window{};
    std::uint64_t events = 0;
    HostTime arrived{};
    bool gap_before = false, reset_before = false;  ///< as in EventWindow
    std::uint64_t images = 0;  ///< reference images the stream had given when the window was cut
};

inline void copy_stamp(const WindowStamp& from, WindowStamp& into) {
    into = from;
}

/// One event window as numbers (docs/model.md, "Input").
struct VoxelGrid : WindowStamp {
    /// [y][x][channel], channels 4 b + {0 polarity, 1 mean, 2 std, 3 count} for bin b < B, then 4 B
    /// = windows since the pixel's last event, clamped at 8, divided by 8 (0 = has events in this
    /// window).
    Array3<float> values;
    /// [y][x], 1 where the pixel has events in this window, else 0; empty where whoever filled the
    /// values did not keep track.
    Array2<std::uint8_t> touched;
    /// [y][x], the last channel as a number of windows, 0 to 8; empty likewise.
    Array2<std::uint8_t> ages;
};

/// Which parts of a latent map changed when, so that whoever holds an older copy need renew only
/// these. Whoever writes the values by hand leaves it as it is constructed: nothing is known.
struct LatentHistory {
    std::uint64_t source = 0;            ///< which encoder's steps are counted; 0: nothing is known
    std::uint64_t step = 0;              ///< the step the values are of
    std::vector<std::uint64_t> changed;  ///< per tile (latent_tiles), the step of its last change
};

/// One code of D numbers per sample.
struct LatentCodes {
    /// [y][x][D] of float32, or where is_bf16 [y][x][(D + 1) / 2] units of two bf16 numbers, as
    /// layers read them (src/nn/numbers.h); codes_in_float() gives float32 of either.
    Array3<float> values;
    bool is_bf16 = false;
    LatentHistory history;
};

/// What the encoder knows after one event window.
struct LatentMap : WindowStamp, LatentCodes {
    Array2<float> events_per_pixel;  ///< [y][x]; empty where not asked for
    /// Codes of an ensemble's mirrored views (EngineOptions::self_ensemble); those of the first
    /// view are the map's own.
    std::vector<LatentCodes> mirrored;
    /// Codes of the blue, the green and the red pixels alone, half as wide and high; empty where
    /// not asked for.
    std::vector<LatentCodes> channels;
};

}  // namespace eventide
