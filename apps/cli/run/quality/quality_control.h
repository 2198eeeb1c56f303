// Lowers and raises quality while a run goes on, by what its work was measured to take.
#pragma once

#include "apps/cli/run/quality/quality_choice.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace eventide::app {

/// What a run has done so far, at one moment.
struct QualityMeasure {
    std::chrono::duration<double> at{0};  ///< since it began
    std::uint64_t windows = 0;            ///< encoded
    std::uint64_t merged = 0;             ///< event windows that became one with another
    std::uint64_t frames = 0;             ///< rendered and written
    std::chrono::duration<double> encode{0}, present{0};  ///< work on them, by the clock
    /// Work on windows by the frames' thread (the camera's images), by the clock.
    std::chrono::duration<double> take{0};
    double pace = 1;  ///< sensor time over that of the clock, as it should be
};

/// What a level may take at most: of the thread that encodes and of the frames', and of the budget.
struct QualityMargin {
    double thread, budget;
};

/// Changes between the levels of one network, best first. It has no clock: measures come with their
/// times, so that tests make them. One thread.
///
/// What a level would take is the profile's figure, scaled by what windows and frames were measured
/// to take. Levels with shorter windows than now are taken to cost at least what the profile says,
/// and to have as many as there can be, as where all moves.
///
/// - A level *holds* within kHolds: encoding and frames each leave their thread a tenth, and both
///   together are within the budget.
/// - Down after 1.5 s in which the present level did not hold, encoding took more than kComfortable
///   though windows might be longer, or windows had to be merged. To longer windows until encoding
///   takes kEasy at most, where it is encoding that took too long; where none are longer, to the
///   next level whose frames take less; else to the best level within kComfortable.
/// - Up after 5 s in which a better level was within kEasy, or the level of the start within
///   kAsChosen. A step up that is taken back within 15 s doubles the wait, a minute without a
///   change halves it: where the load lies between two levels, the better one is tried once a
///   minute.
class QualityControl {
public:
    /// `at`: the level it begins with.
    QualityControl(PrecisionCost profile, std::vector<QualityLevel> levels, std::size_t at,
                   const QualityDemand& demand);

    /// Often, 2 times a second or more. True where the level was changed.
    bool look(const QualityMeasure& now);

    const QualityLevel& level() const { return levels_[at_]; }
    /// What the level at the last look took, of a thread each.
    NetworkLoad measured() const { return measured_; }

private:
    using Seconds = std::chrono::duration<double>;
    void learn(const QualityMeasure& now);
    void learn_windows(const QualityMeasure& now);
    bool can_lengthen(std::size_t level) const;
    std::size_t with_fewer_windows() const;
    bool is_shorter(std::size_t level) const;
    NetworkLoad load_at(std::size_t level) const;
    bool holds(std::size_t level, QualityMargin margin) const;
    bool move(std::size_t to, Seconds now);
    bool lower(Seconds now);
    bool raise(Seconds now);
    void forget(Seconds now);

    const PrecisionCost profile_;
    const std::vector<QualityLevel> levels_;
    const double asked_;  // frames a second at pace 1
    std::size_t at_;
    const std::size_t chosen_;  // at the start
    QualityDemand demand_;
    double encode_factor_, frame_factor_;  // work by the clock over the profile's processor time
    double take_s_ = 0;                    // by the clock, for each window
    NetworkLoad measured_;
    bool merging_ = false;
    QualityMeasure before_;
    unsigned strained_ = 0;  // looks in a row
    Seconds calm_since_{0}, raised_{-1e9}, settled_{0}, raise_wait_;
};

}  // namespace eventide::app
