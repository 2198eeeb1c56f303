// Leaves out what flickering light adds to a scene's events.
#pragma once

#include "src/binning/flicker_period.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

/// Light that flickers makes a pixel fire on and off in turn, a half, one and a half, ... periods
/// apart. Such pairs sum up to nothing, and both events are left out; what moves changes brightness
/// for longer, and stays. While light flickers (FlickerPeriod) events are therefore held back as
/// long as the one that would complete their pair may come; otherwise nothing is left out or held.
///
/// Deterministic: depends on the events, not on how they are split. Where time goes back, what is
/// held comes out. One thread at a time.
class FlickerPairs {
public:
    static constexpr SensorDuration kLongest{100'000};
    /// More come out before their time.
    static constexpr std::size_t kMostHeld = std::size_t{1} << 22;

    /// Sensor of width x height px. `longest` between the events of a pair, and so how long events
    /// are held back: 0 to kLongest; 0: three quarters of a period. `renumber_at`: events after
    /// which their numbers start again, which changes nothing that comes out; for tests.
    FlickerPairs(int width, int height, SensorDuration longest,
                 std::uint32_t renumber_at = std::uint32_t{1} << 31);

    /// Events in order of time, on the sensor, become those that come out now, in order.
    void process(std::vector<Event>& events);
    /// Appends what comes out as time goes on: no event before `now` will come any more.
    void release(SensorTime now, std::vector<Event>& events);
    /// Appends all that is held back.
    void flush(std::vector<Event>& events);

    /// Once all events before `now` were processed, none before this time will come out any more.
    SensorTime known_until(SensorTime now) const { return now - delay(); }
    std::size_t held() const { return held_count_; }           ///< events that may come out yet
    std::uint64_t left_out() const { return left_out_; }       ///< events, since construction
    double period_us() const { return period_.us(); }          ///< 0: nothing flickers
    double last_period_us() const { return last_period_us_; }  ///< that was found

    void reset() noexcept;  ///< as constructed

    /// What another one needs to go on from here.
    struct State {
        FlickerPeriod::State period;
        std::vector<Event> held;
        friend bool operator==(const State&, const State&) = default;
    };
    State state() const;
    /// Throws Error (input) for the state of another sensor, and is then as it was.
    void restore(const State& state);

private:
    struct Held {
        Event event;
        std::uint32_t before;  // of the pixel, as in newest_
        bool left_out;
    };
    SensorDuration delay() const;
    std::uint32_t& newest_of(const Event& event) {
        return newest_[std::size_t(event.y) * std::size_t(width_) + event.x];
    }
    bool is_pair(const Event& a, const Event& b) const;
    void hold(const Event& event);
    void keep(const Event& event);
    void forget_held() noexcept;
    void let_go(std::vector<Event>& events);
    void renumber() noexcept;

    int width_;
    SensorDuration longest_;
    std::uint32_t renumber_at_;
    FlickerPeriod period_;
    std::vector<Held> held_;  // in order of time; those before gone_ have come out
    std::size_t gone_ = 0;
    std::uint32_t first_ = 1;     // number of held_[gone_]; 0 stands for none
    std::size_t held_count_ = 0;  // of those that are not left out
    /// [y][x]: number of the pixel's newest event that is not left out.
    std::vector<std::uint32_t> newest_;
    std::uint64_t left_out_ = 0;
    double last_period_us_ = 0;
    SensorTime now_ = SensorTime::min();
    std::vector<Event> out_;
};

/// "auto": three quarters of a period, or 16 ms of a recording, which can wait; "off"; or how long
/// events may be held back, such as "10ms". Empty: off. Throws Error (usage).
std::optional<SensorDuration> parse_lamp_flicker(std::string_view text, bool can_wait);

}  // namespace eventide
