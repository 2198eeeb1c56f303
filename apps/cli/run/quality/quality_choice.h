// The best quality that holds the pace: a pure function of figures.
#pragma once

#include "apps/cli/run/quality/quality_profile.h"
#include "src/core/sensor_time.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace eventide::app {

/// The clock of frames stays; every 2^halvings-th of its frames is rendered.
struct QualityLevel {
    double scale = 1;  ///< of the frames, times the sensor's size
    unsigned halvings = 0;
    /// Of sensor time: no event ends an event window sooner. 0: events end none, all windows are
    /// alike.
    SensorDuration min_window{0};
    friend bool operator==(const QualityLevel&, const QualityLevel&) = default;
};

/// For windows that events end, no longer than `widest`: how soon they may, the least first.
std::vector<SensorDuration> min_windows(SensorDuration widest);

/// From the best on: at each size and rate short event windows are given up first, at each size
/// then the rate, down to a quarter, then the size, to a third, as none between costs less than the
/// whole (PrecisionCost). Where rate or scale is not open, it stays as `as_asked` has it; so do
/// windows, where none are given.
std::vector<QualityLevel> quality_levels(const QualityLevel& as_asked, bool rate_open,
                                         bool scale_open,
                                         std::span<const SensorDuration> windows = {});

/// What has to be done in a second of the clock on the wall.
struct QualityDemand {
    double windows = 20;          ///< event windows, where events end none of them
    double frames = 30;           ///< frames asked for, before halvings
    double threads = 1;           ///< that the network may use
    std::optional<double> share;  ///< --budget: processor time, in cores
    double pace = 1;              ///< sensor time over that of the clock, in windows and frames
};

/// Event windows a second at this level: where events end them, as many as there can be.
double windows_at(const QualityLevel& level, const QualityDemand& demand);

/// What encoding and frames take, as parts of a core.
struct NetworkLoad {
    double encode = 0, frames = 0;
    double total() const { return encode + frames; }
};

/// By the profile, everything moving.
NetworkLoad load_of(const PrecisionCost& cost, const QualityLevel& level,
                    const QualityDemand& demand);
/// The same with so many event windows a second.
NetworkLoad load_of(const PrecisionCost& cost, const QualityLevel& level,
                    const QualityDemand& demand, double windows);

/// What of a core the network may take, before anything is known of this run: what its threads do
/// within the budget, and at most 70 % of what they do, each further one 70 % of the first.
double affordable_load(const QualityDemand& demand);

/// So many cores are what the network's threads do together.
double cores_of(double threads);

struct QualityChoice {
    std::size_t model = 0;  ///< of those given
    Precision precision = Precision::f32;
    QualityLevel level;
    NetworkLoad load;
    bool holds = true;  ///< false: nothing does; this is the least that could be chosen
};

/// The first of the levels that can be afforded, with the quicker of its precisions (they differ in
/// error by less than half a per cent): of all that are left to choose, no better one holds. Empty
/// where none of the levels does.
std::optional<QualityChoice> best_that_holds(std::span<const PrecisionCost> costs,
                                             std::span<const QualityLevel> levels,
                                             const QualityDemand& demand);

/// The cheapest of all levels, whether it holds or not.
QualityChoice least_load(std::span<const PrecisionCost> costs, std::span<const QualityLevel> levels,
                         const QualityDemand& demand);

}  // namespace eventide::app
