/// @file
/// A rendered frame, and how one is asked for.
#pragma once

#include <eventide/array.h>
#include <eventide/sensor_time.h>

#include <array>
#include <cstdint>

namespace eventide {

/// One rendered frame.
struct Frame {
    SensorTime t{};            ///< the instant it shows
    Window window;             ///< of the event window t lies in
    std::uint64_t index = 0;   ///< number on the frame clock, t = t0 + index / fps: a jump is a
                               ///< skipped frame. 0 where the time was asked for by itself
    std::uint64_t events = 0;  ///< in that event window
    Array2<float> intensity;   ///< [y][x], 0 black to 1 white; may lie a little outside
    Array2<float> sigma;       ///< [y][x], standard deviation, in units of intensity; empty where
                               ///< not asked for
    /// [y][x] each, blue, green, red, in units of intensity; empty where not asked for
    std::array<Array2<float>, 3> colour;
    HostTime arrived{};       ///< when the newest events the frame saw came in; now minus this is
                              ///< the latency
    bool gap_before = false;  ///< data were lost before or in that event window, or before an
                              ///< earlier one that no frame shows
    Array2<float> event_preview;  ///< [y][x], sum of polarities of that event window, sensor size;
                                  ///< empty where not asked for
};

/// A part of a frame.
struct Region {
    int x = 0;       ///< px, its left edge
    int y = 0;       ///< px, its top edge
    int width = 0;   ///< px; 0: to the frame's right edge
    int height = 0;  ///< px; 0: to the frame's bottom edge
};

/// px each way: no frame is larger.
constexpr int kLargestFrameSide = 16384;

/// How large a frame is to be, and which part of it is wanted.
struct FrameSize {
    int width = 0;    ///< px, of the whole frame, 1 to kLargestFrameSide; 0: the sensor's
    int height = 0;   ///< px, likewise
    Region region{};  ///< the part of it that is wanted; the default is all of it
};

/// Whether a frame of some time can be rendered.
enum class Readiness {
    ready,  ///< it can
    later,  ///< events it needs have yet to come
    gone,   ///< before the first event window, or too long ago: its memory is no longer kept
};

}  // namespace eventide
