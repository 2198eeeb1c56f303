// How the stream of events is cut into event windows, and the text that says so ("--window").
#pragma once

#include "src/core/sensor_time.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace eventide {

enum class WindowRule : std::uint8_t {
    duration,  ///< constant width
    count,     ///< constant number of events, ended early at max_width
    content,   ///< once the busiest tiles have seen enough (tile_activity.h), or at max_width
    reference  ///< from reference image to reference image, ended early at max_width
};

struct SlicerSettings {
    WindowRule rule = WindowRule::duration;
    SensorDuration width{50'000};   ///< of each window, rule duration; >= 1 us
    std::uint64_t events = 20'000;  ///< per window, rule count; >= 1
    /// Rule count: where > 0, `events` is this times the pixels. Rule content: of the busiest
    /// tiles, where a pixel counts for TileActivity::kMostOfAPixel at most.
    double events_per_pixel = 0;
    SensorDuration min_width{1'000};  ///< rule content: no event ends a window before

    /// Rules count, content and reference: no window is wider, so that a still scene ends its
    /// windows too.
    SensorDuration max_width{100'000};

    /// Rule reference: where no image is known, a window ends at max_width only when the stream is
    /// this much further, because images come after the events around their time (a DAVIS sends
    /// one when it is read out, files store it in a later packet).
    SensorDuration reference_wait{1'000'000};

    /// All rules: a window ends early after so many events, which bounds memory (16 bytes each).
    /// Events of the same microsecond stay together; past so many of one microsecond the rest are
    /// left out and counted.
    std::uint64_t max_events = std::uint64_t{1} << 24;

    /// After so many empty windows in a row, the rest of a silence that is known to be over (or has
    /// passed at one step) comes as one wide empty window: a jump of hours gives a handful of
    /// windows. By then every input of the network has stopped changing. The last few come one by
    /// one, so that no frame of the wide one reads what comes after the silence.
    int silent_windows = 16;

    /// The first window's begin: earlier events are left out. Empty: 1 us before the first event or
    /// clock, so that the first event is inside.
    std::optional<SensorTime> begin{};
    /// Later events are left out and the last window ends here. Empty: at the stream's end.
    std::optional<SensorTime> end{};
    /// Where a live stream's times are not known before: the end is this long after the first
    /// window's begin, in silence too; what is left of it goes on where the clock was reset.
    std::optional<SensorDuration> duration{};
};

/// Throws Error (usage) naming what is out of range, for a sensor of width x height px.
void check_slicer_settings(const SlicerSettings& settings, int width, int height);

/// The width of an event window that no event, image or end of the stream ends before.
SensorDuration natural_width(const SlicerSettings& settings);

/// An event window ends early after so many events.
std::uint64_t events_per_window(const SlicerSettings& settings, int width, int height);

/// "50ms", "20000ev", "0.35epp" (events per pixel), "aps" (reference images) or "auto" (content);
/// durations in us, ms or s; after a comma the maximum width: "20000ev,200ms"; for "auto", after
/// another one, the minimum width: "auto,50ms,5ms". Throws Error (usage).
SlicerSettings parse_window(std::string_view text);

/// What parse_window() reads back.
std::string window_text(const SlicerSettings& settings);

}  // namespace eventide
