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
/// them are multiples of, if there is one. Pixels may skip cycles, and lamps may differ in phase.
///
/// Looks at a quarter of the pixels. Deterministic: depends on the events, not on how they are
/// split.
class FlickerPeriod {
public:
    static constexpr double kShortestUs = 1'250, kLongestUs = 12'500;  ///< 800 to 80 Hz

    /// Sensor of width x height px.
    FlickerPeriod(int width, int height);

    /// The next event in the order of time, on the sensor.
    void see(const Event& event) noexcept;

    /// us; 0: nothing is known to flicker. By what was seen until kBlock ago or less.
    double us() const { return state_.period_us; }

    void reset() noexcept;  ///< as constructed

    static constexpr int kBinUs = 50;
    static constexpr int kBins = int(3.5 * kLongestUs) / kBinUs;  ///< three periods and a half

    /// All that it has learned, to go on from elsewhere.
    struct State {
        /// [y][x]: us of the last rise (31 bits), and 1 where the newest event is on
        std::vector<std::uint32_t> rises;
        std::array<std::uint32_t, kBins> intervals{};  ///< between rises, in this block
        std::optional<SensorTime> block;               ///< its begin
        double period_us = 0;
        double found_us = 0;  ///< in the last block
        int unsaid = 0;       ///< blocks in a row with too few intervals
        friend bool operator==(const State&, const State&) = default;
    };
    const State& state() const { return state_; }
    /// Throws Error (input) for the state of another sensor, and is then as it was.
    void restore(const State& state);

private:
    static constexpr SensorDuration kBlock{50'000};

    /// Intervals near whole numbers of periods, and near halves between them.
    struct Comb {
        double whole = 0, between = 0;  // per bin
        double excess = 0;              // intervals
    };
    void note(const Event& event) noexcept;
    bool is_flicker(const Comb& comb, double least) const noexcept;
    void end_block() noexcept;
    using Sums = std::array<std::uint32_t, kBins + 1>;  // of the intervals in all bins before
    Sums sums() const noexcept;
    static Comb comb(const Sums& sums, double period_us) noexcept;
    double refined(double period_us) const noexcept;
    double period_of_block() const noexcept;

    int width_;
    State state_;
    std::uint32_t counted_ = 0;  // of the intervals
};

}  // namespace eventide
