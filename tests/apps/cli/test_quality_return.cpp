// The quality that was chosen at the start holds, and comes back after a load that passed.
#include "apps/cli/run/quality/quality_control.h"
#include "tests/apps/cli/quality_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace eventide::app {
namespace {

using namespace std::chrono_literals;

/// Windows and frames that take so many times what the profile says; begins with the best level
/// that holds by it.
class ChosenRun {
public:
    ChosenRun(const PrecisionCost& cost, std::vector<QualityLevel> levels, QualityDemand demand)
        : cost_{cost}, demand_{demand}, levels_{std::move(levels)} {
        const auto best = best_that_holds({&cost_, 1}, levels_, demand_);
        if (!best) return;
        const auto at = std::find(levels_.begin(), levels_.end(), best->level) - levels_.begin();
        control_.emplace(cost_, levels_, std::size_t(at), demand_);
    }

    /// Whether any level holds.
    bool can_begin() const { return control_.has_value(); }
    const QualityLevel& level() const { return control_->level(); }

    /// `moving`: of the windows that there can be.
    void run(double seconds, double cost, double moving) {
        for (int i = 0; i < int(seconds * 2); ++i) {
            windows_ += std::max(20., moving * windows_at(level(), demand_)) / 2;
            frames_ += demand_.frames / double(1U << level().halvings) / 2;
            const auto windows = double(std::uint64_t(windows_) - now_.windows),
                       frames = double(std::uint64_t(frames_) - now_.frames);
            now_.at += Seconds{.5};
            now_.windows = std::uint64_t(windows_);
            now_.frames = std::uint64_t(frames_);
            const double scale = 1e-3 * cost / cores_of(demand_.threads);
            now_.encode += Seconds{windows * cost_.encode_ms * scale};
            now_.present += Seconds{
                (std::min(windows, frames) * cost_.first_ms + frames * cost_.full_ms) * scale};
            control_->look(now_);
        }
    }

private:
    PrecisionCost cost_;
    QualityDemand demand_;
    std::vector<QualityLevel> levels_;
    std::optional<QualityControl> control_;
    QualityMeasure now_;
    double windows_ = 0, frames_ = 0;
};

/// Calls `check` with runs of slow and quick networks.
template <typename Check>
void for_each_run(std::optional<double> share, double threads, Check check) {
    int begun = 0;
    for (const bool by_content : {false, true})
        for (double encode_ms = .6; encode_ms < 20; encode_ms *= 1.12) {
            const PrecisionCost cost{Precision::f32, "one", encode_ms, .2, 2, 2, .6};
            const auto windows = by_content ? min_windows(50ms) : std::vector<SensorDuration>{};
            ChosenRun run{
                cost, quality_levels({1, 0}, true, false, windows), {20, 30, threads, share}};
            if (!run.can_begin()) continue;
            ++begun;
            SCOPED_TRACE(testing::Message() << encode_ms << " ms, by content: " << by_content);
            check(run);
        }
    EXPECT_GT(begun, 20);
}

TEST(QualityControl, KeepsWhatWasChosenWhereAllMovesAsInTheProfile) {
    for (const std::optional<double> share : {std::optional<double>{}, {.5}, {1.}})
        for_each_run(share, 1, [](ChosenRun& run) {
            const QualityLevel chosen = run.level();
            run.run(60, 1, 1);
            EXPECT_EQ(run.level(), chosen);
        });
}

TEST(QualityControl, ComesBackToWhatWasChosenAfterALoadThatPassed) {
    for (const std::optional<double> share : {std::optional<double>{}, {.5}, {1.}})
        for (const double threads : {1., 2.})
            for_each_run(share, threads, [](ChosenRun& run) {
                const QualityLevel chosen = run.level();
                run.run(4, 6, 1);  // another program took the processor
                run.run(600, .95, 1);
                EXPECT_EQ(run.level(), chosen);
            });
}

}  // namespace
}  // namespace eventide::app
