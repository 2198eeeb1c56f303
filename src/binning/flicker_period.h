// How fast lamps or screens flicker in what a sensor sees.
#pragma once

#include "src/core/event.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace eventide {

/// Where light flickers, a pixel's brightness begins to rise (an on event after an off event) a
/// whole number of periods after it did before; where things move, after any time. So from the
/// times between rises of all pixels, in some tenth of a second, the period follows that most of
/// them are multiples of, if there is one. Pixels may skip cycles.
///
/// A wheel whose spokes pass as often does the same to each pixel, but to each at another time.
/// Light is everywhere at once: its rises come in one part of the period, or, by lamps on the three
/// phases of the mains, in three.
///
/// Looks at a quarter of the pixels. Deterministic: depends on the events, not on how they are
/// split.
class FlickerPeriod {
public:
    static constexpr double kShortestUs = 1'250, kLongestUs = 12'500;  ///< 800 to 80 Hz

    /// Sensor of width x height px.
    FlickerPeriod(int width, int height);

    /// The next event in the order of time, on the sensor.
    void see(const Event& event) noexcept {
        if (((event.x + event.y) & 3) == 0) watch(event);
    }

    /// us; 0: nothing is known to flicker. By what was seen until kBlock ago or less.
    double us() const { return state_.period_us; }

    void reset() noexcept;  ///< as constructed

    static constexpr int kBinUs = 50;
    static constexpr int kBins = int(3.5 * kLongestUs) / kBinUs;  ///< three periods and a half
    static constexpr int kMostUnsaid = 20;  ///< blocks that say nothing, until nothing is known
    static constexpr int kTickUs = 100;     ///< of the times of rises
    static constexpr int kTicksABlock = 500;
    static constexpr int kTicks = kMostUnsaid * kTicksABlock;

    /// All that it has learned, to go on from elsewhere.
    struct State {
        /// [y][x]: us of the last rise (31 bits), and 1 where the newest event is on
        std::vector<std::uint32_t> rises;
        /// Between rises, in this block and those before that said nothing; [i / kBinUs]
        std::array<std::uint32_t, kBins> intervals{};
        /// When they ended; [(t - since) / kTickUs]
        std::vector<std::uint32_t> when;
        std::optional<SensorTime> block;  ///< its begin
        SensorTime since{};               ///< that of the first of them
        double period_us = 0;
        double found_us = 0;  ///< in the last block
        int unsaid = 0;       ///< blocks in a row with too few intervals
        friend bool operator==(const State&, const State&) = default;
    };
    const State& state() const { return state_; }
    /// Throws Error (input) for the state of another sensor, and is then as it was.
    void restore(const State& state);

private:
    static constexpr SensorDuration kBlock{kTicksABlock * kTickUs};

    /// Intervals near whole numbers of periods, and near halves between them.
    struct Comb {
        double whole = 0, between = 0;  // per bin
        double excess = 0;              // intervals
    };
    void watch(const Event& event) noexcept;
    void forget_rises(SensorTime t) noexcept;
    void begin_block(SensorTime t) noexcept;
    void note(const Event& event) noexcept;
    void clear_intervals() noexcept;
    int ticks() const noexcept;
    bool is_periodic(const Comb& comb, double least) const noexcept;
    bool is_in_step(double period_us, double excess, double least) const noexcept;
    double in_phase(double period_us, int part) const noexcept;
    void end_block() noexcept;
    using Cumulative = std::array<std::uint32_t, kBins + 1>;  // intervals in all bins before
    Cumulative cumulative() const noexcept;
    static Comb comb(const Cumulative& before, double period_us) noexcept;
    double refined(double period_us) const noexcept;
    double period_of_block() const noexcept;

    int width_;
    State state_;
    std::uint32_t counted_ = 0;  // of the intervals
};

}  // namespace eventide
