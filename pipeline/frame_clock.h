// When frames are asked for: at t0 + k / fps in sensor time, whatever the packets do.
#pragma once

#include "src/core/sensor_time.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace eventide {

/// Frames per second as a fraction, so that 29.97 or 30000/1001 do not drift.
struct FrameRate {
    std::int64_t frames = 0;  ///< 0: no rate, one frame at the end of each event window
    std::int64_t seconds = 1;

    bool is_set() const { return frames > 0; }
    friend bool operator==(const FrameRate&, const FrameRate&) = default;
};

/// "120", "29.97", "30000/1001": more than 0, at most 1e6 (time has steps of 1 us). Throws Error
/// (usage).
FrameRate parse_frame_rate(std::string_view text);

/// The rate in sensor time of a video that is `slow` times (0.001 to 1e5, exact to thousandths) as
/// long as what it shows and has `rate` in its own. Throws Error (usage) for more than 1e6.
FrameRate slowed(const FrameRate& rate, double slow);

/// t0 + k / fps, rounded to the nearest microsecond: each from k itself, so nothing accumulates.
class FrameClock {
public:
    FrameClock(FrameRate rate, SensorTime t0) : rate_(rate), t0_(t0) {}

    SensorTime time_of(std::uint64_t index) const;

    /// How many frames are at or before t: the index of the first one after it.
    std::uint64_t count_until(SensorTime t) const;

private:
    FrameRate rate_;
    SensorTime t0_;
};

/// Whether a frame of the clock is one of every 2^halvings-th.
constexpr bool is_kept(std::uint64_t index, unsigned halvings) {
    return (index & ((std::uint64_t{1} << halvings) - 1)) == 0;
}
/// How many of the frames before `end` are.
constexpr std::uint64_t kept_before(std::uint64_t end, unsigned halvings) {
    const std::uint64_t step = std::uint64_t{1} << halvings;
    return (end + step - 1) / step;
}

/// One frame asked for.
struct DueFrame {
    SensorTime t;
    std::uint64_t index;
};

/// Which frames lie in which event window. Event windows come one by one and follow each other.
class FrameSchedule {
public:
    /// t0 is the first event window's begin, or `from` where that is later: no frame is asked for
    /// before it (event windows before it warm up the encoder's state).
    explicit FrameSchedule(FrameRate rate, std::optional<SensorTime> from = {})
        : rate_(rate), from_(from) {}

    /// The frames with begin < t <= end become due; the first event window's include its begin.
    void open(Window window);

    /// How many frames of the open event window are still due, and the next of them.
    std::uint64_t due() const { return end_ - next_; }
    std::uint64_t next_index() const { return next_; }
    DueFrame next();

    /// Leaves out what is due.
    void skip(std::uint64_t frames) { next_ += frames; }

    /// Before open(): from the next frame on they come at this rate, the first of them one step
    /// after the last; indices go on.
    void change_rate(const FrameRate& rate);

    /// Clock reset: the next event window is of a new stream; indices go on.
    void restart();

private:
    FrameRate rate_;
    std::optional<SensorTime> from_;
    std::optional<FrameClock> clock_;  // counts from base_
    std::uint64_t base_ = 0, next_ = 0, end_ = 0;
    SensorTime window_end_{};
    std::optional<SensorTime> last_;  // frame before the rate was changed
};

}  // namespace eventide
