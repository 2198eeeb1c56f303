// Finds the pixels of an event sensor that fire by themselves.
#pragma once

#include "src/core/event.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace eventide {

/// At the end of each interval of sensor time a pixel becomes hot when it fired at least `hz` and
/// kTimesNeighbours times as often as the second busiest of the eight around it: what moves or
/// trembles, and be it a line of one pixel, makes neighbours fire; a hot pixel, or two side by
/// side, stand alone. It stays hot until it fires at less than half of `hz`. Where time goes back,
/// the interval begins anew.
///
/// Deterministic: what is hot depends on the events, not on how they are split. One thread.
class HotPixels {
public:
    static constexpr std::uint32_t kTimesNeighbours = 4;

    /// Sensor of width x height px. hz * interval is at least 2 events.
    HotPixels(int width, int height, double hz, SensorDuration interval);

    /// Counts an event, which lies on the sensor; true where its pixel was found hot before it.
    bool is_hot(const Event& event) noexcept {
        advance(event.t);
        Pixel& pixel = pixels_[at(event)];
        ++pixel.events;
        return pixel.hot;
    }

    /// Asks the processor for what is_hot() of a later event will read.
    void prefetch(const Event& event) const noexcept { __builtin_prefetch(&pixels_[at(event)], 1); }

    /// How many pixels are hot now.
    std::size_t count() const;

    void reset() noexcept;  ///< as constructed

    /// All that it has learned, to go on from elsewhere.
    struct State {
        std::vector<std::uint32_t> events;  ///< [y][x], of the open interval
        std::vector<std::uint8_t> hot;      ///< [y][x], 0 or 1
        std::optional<SensorTime> interval_end;
        friend bool operator==(const State&, const State&) = default;
    };
    State state() const;
    /// Throws Error (input) for the state of another sensor, and is then as it was.
    void restore(const State& state);

private:
    struct Pixel {
        std::uint32_t events : 31 = 0;  // of this interval
        bool hot : 1 = false;
    };
    std::size_t at(const Event& event) const {
        return std::size_t(event.y) * std::size_t(width_) + event.x;
    }
    void advance(SensorTime t) noexcept {
        if (!interval_end_ || t >= *interval_end_ || t < last_) renew(t);
        last_ = t;
    }
    void renew(SensorTime t) noexcept;
    void end_interval() noexcept;
    std::uint32_t second_busiest_around(int y, int x) const noexcept;

    int width_, height_;
    std::uint32_t hot_count_;
    SensorDuration interval_;
    std::vector<Pixel> pixels_;  // [y][x]
    std::optional<SensorTime> interval_end_;
    SensorTime last_ = SensorTime::min();  // event
};

}  // namespace eventide
