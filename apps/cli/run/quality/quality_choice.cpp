// The best quality that holds the pace.
#include "apps/cli/run/quality/quality_choice.h"

#include <algorithm>
#include <cmath>

namespace eventide::app {

namespace {

constexpr double kThird = 1.0 / 3;

/// A frame, without what is done once for its event window.
double frame_ms(const PrecisionCost& cost, double scale) {
    const auto is = [scale](double known) { return std::abs(scale - known) < 1e-6; };
    if (is(1)) return cost.full_ms;
    if (is(kThird)) return cost.third_ms;
    return cost.half_ms * scale * scale / 0.25;
}

/// The quicker one; float32 where they are alike.
QualityChoice quicker(std::span<const PrecisionCost> costs, const QualityLevel& level,
                      const QualityDemand& demand) {
    QualityChoice best;
    for (const PrecisionCost& cost : costs) {
        const NetworkLoad load = load_of(cost, level, demand);
        if (&cost == &costs.front() || load.total() < best.load.total())
            best = {0, cost.precision, level, load, load.total() <= affordable_load(demand)};
    }
    return best;
}

}  // namespace

std::vector<SensorDuration> min_windows(SensorDuration widest) {
    std::vector<SensorDuration> windows;
    for (const int ms : {2, 3, 5, 7, 10, 15, 20, 30})
        if (SensorDuration{1000 * ms} < widest) windows.emplace_back(1000 * ms);
    windows.push_back(widest);
    return windows;
}

std::vector<QualityLevel> quality_levels(const QualityLevel& as_asked, bool rate_open,
                                         bool scale_open, std::span<const SensorDuration> windows) {
    constexpr double kScales[]{1, kThird};
    constexpr unsigned kHalvings = 2;
    if (windows.empty()) windows = {&as_asked.min_window, 1};
    std::vector<QualityLevel> levels;
    for (const double scale : kScales) {
        for (unsigned halvings = 0; halvings <= (rate_open ? kHalvings : 0); ++halvings)
            for (const SensorDuration shortest : windows)
                levels.push_back({as_asked.scale * scale, as_asked.halvings + halvings, shortest});
        if (!scale_open) break;
    }
    return levels;
}

double windows_at(const QualityLevel& level, const QualityDemand& demand) {
    if (level.min_window.count() == 0) return demand.windows;
    return 1e6 / double(level.min_window.count()) * demand.pace;
}

NetworkLoad load_of(const PrecisionCost& cost, const QualityLevel& level,
                    const QualityDemand& demand) {
    return load_of(cost, level, demand, windows_at(level, demand));
}

NetworkLoad load_of(const PrecisionCost& cost, const QualityLevel& level,
                    const QualityDemand& demand, double windows) {
    const double frames = demand.frames / double(1U << level.halvings);
    const double first = std::min(frames, windows);  // windows that frames are rendered of
    return {1e-3 * cost.encode_ms * windows,
            1e-3 * (cost.first_ms * first + frame_ms(cost, level.scale) * frames)};
}

double cores_of(double threads) {
    constexpr double kFurther = 0.7;
    return 1 + kFurther * (std::max(threads, 1.0) - 1);
}

double affordable_load(const QualityDemand& demand) {
    constexpr double kShare = 0.7;
    const double cores = cores_of(demand.threads), pace = kShare * cores;
    if (!demand.share) return pace;
    return std::min(*demand.share * cores / std::max(demand.threads, 1.0), pace);
}

std::optional<QualityChoice> best_that_holds(std::span<const PrecisionCost> costs,
                                             std::span<const QualityLevel> levels,
                                             const QualityDemand& demand) {
    for (const QualityLevel& level : levels)
        if (const QualityChoice choice = quicker(costs, level, demand); choice.holds) return choice;
    return {};
}

QualityChoice least_load(std::span<const PrecisionCost> costs, std::span<const QualityLevel> levels,
                         const QualityDemand& demand) {
    QualityChoice least;
    for (const QualityLevel& level : levels)
        if (const QualityChoice choice = quicker(costs, level, demand);
            &level == &levels.front() || choice.load.total() < least.load.total())
            least = choice;
    return least;
}

}  // namespace eventide::app
