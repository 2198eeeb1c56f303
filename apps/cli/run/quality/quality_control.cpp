// Lowers and raises quality while a run goes on.
#include "apps/cli/run/quality/quality_control.h"

#include <algorithm>
#include <utility>

namespace eventide::app {

namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds kLook{0.5};     // shorter spans jump
constexpr Seconds kRaiseWait{5};  // before a step up
constexpr Seconds kTakenBack{15}, kForgotten{60};
constexpr unsigned kStrainedLooks = 3;
constexpr double kFewMerged = 0.05;  // of the windows: single ones wait for a frame
// A level as it was chosen at the start may take 70 % of what its threads do, and all of the
// budget (affordable_load): what is asked of it later is no more.
constexpr QualityMargin kHolds{0.9, 1}, kAsChosen{0.75, 1}, kComfortable{0.75, 0.75},
    kEasy{0.6, 0.6};

/// Half of a measure is what was known: single windows may be slow for reasons of their own.
void mix(double& known, double found) {
    known += 0.5 * (found - known);
}

}  // namespace

QualityControl::QualityControl(PrecisionCost profile, std::vector<QualityLevel> levels,
                               std::size_t at, const QualityDemand& demand)
    : profile_{std::move(profile)},
      levels_{std::move(levels)},
      asked_{demand.frames / (demand.pace > 0 ? demand.pace : 1)},
      at_{at},
      chosen_{at},
      demand_{demand},
      encode_factor_{1 / std::max(demand.threads, 1.0)},
      frame_factor_{encode_factor_},
      raise_wait_{kRaiseWait} {
    demand_.windows = windows_at(level(), demand_);
}

/// Whether its event windows may be shorter than now.
bool QualityControl::is_shorter(std::size_t level) const {
    return levels_[level].min_window < levels_[at_].min_window;
}

NetworkLoad QualityControl::load_at(std::size_t level) const {
    double windows = windows_at(levels_[level], demand_), encode_factor = encode_factor_;
    if (is_shorter(level))
        encode_factor = std::max(encode_factor, 1 / cores_of(demand_.threads));
    else
        windows = std::min(windows, demand_.windows);
    const NetworkLoad load = load_of(profile_, levels_[level], demand_, windows);
    return {load.encode * encode_factor, load.frames * frame_factor_ + take_s_ * windows};
}

bool QualityControl::holds(std::size_t level, QualityMargin margin) const {
    const NetworkLoad load = load_at(level);
    if (std::max(load.encode, load.frames) > margin.thread) return false;
    return !demand_.share ||
           load.total() * std::max(demand_.threads, 1.0) <= margin.budget * *demand_.share;
}

void QualityControl::learn_windows(const QualityMeasure& now) {
    const double seconds = (now.at - before_.at).count();
    const auto windows = double(now.windows - before_.windows),
               merged = double(now.merged - before_.merged);
    merging_ = merged > kFewMerged * (windows + merged);
    demand_.pace = now.pace;
    if (windows == 0 || seconds <= 0) return;
    mix(demand_.windows, (windows + merged) / seconds);
    mix(encode_factor_,
        (now.encode - before_.encode).count() / windows / (1e-3 * profile_.encode_ms));
    mix(take_s_, (now.take - before_.take).count() / windows);
}

void QualityControl::learn(const QualityMeasure& now) {
    learn_windows(now);
    const auto frames = double(now.frames - before_.frames);
    demand_.frames = asked_ * now.pace;
    const double rate = demand_.frames / double(1U << level().halvings);
    if (frames == 0 || rate <= 0) return;
    const double expected = load_of(profile_, level(), demand_, demand_.windows).frames / rate;
    if (expected > 0)
        mix(frame_factor_, (now.present - before_.present).count() / frames / expected);
}

bool QualityControl::look(const QualityMeasure& now) {
    const Seconds passed = now.at - before_.at;
    if (passed < kLook) return false;
    const bool idle = now.windows == before_.windows;
    learn(now);
    measured_ = load_at(at_);
    before_ = now;
    if (idle) return false;  // a camera that is silent, or a page that was paused
    const bool strained = merging_ || !holds(at_, kHolds) ||
                          (measured_.encode > kComfortable.thread && can_lengthen(at_));
    strained_ = strained ? strained_ + 1 : 0;
    if (strained) calm_since_ = now.at;
    if (strained_ >= kStrainedLooks) return lower(now.at);
    return raise(now.at);
}

/// Whether the next level down differs by longer event windows.
bool QualityControl::can_lengthen(std::size_t level) const {
    return level + 1 < levels_.size() && levels_[level + 1].min_window > levels_[level].min_window;
}

/// The first level from the present one on whose windows are few enough for the encoder; the one
/// with the fewest, where none's are.
std::size_t QualityControl::with_fewer_windows() const {
    std::size_t to = at_;
    while (can_lengthen(to) && load_at(to).encode > kEasy.thread) ++to;
    return to;
}

bool QualityControl::lower(Seconds now) {
    std::size_t to = at_ + 1;
    const NetworkLoad load = load_at(at_);
    if (load.encode > kComfortable.thread && can_lengthen(at_)) {
        to = with_fewer_windows();
    } else if (load.encode > kHolds.thread) {
        // Windows gain only the cores that frames leave: one step, over levels (small frames, but
        // all of them) that would take more.
        while (to < levels_.size() && (is_shorter(to) || load_at(to).frames >= load.frames)) ++to;
    } else {
        while (to + 1 < levels_.size() && !holds(to, kComfortable)) ++to;
    }
    if (to >= levels_.size()) return false;
    if (now - raised_ < kTakenBack) raise_wait_ *= 2;
    return move(to, now);
}

bool QualityControl::raise(Seconds now) {
    forget(now);
    std::size_t to = 0;
    while (to < at_ && !holds(to, to == chosen_ ? kAsChosen : kEasy)) ++to;
    if (to == at_) calm_since_ = now;
    if (now - calm_since_ < raise_wait_) return false;
    raised_ = now;
    return move(to, now);
}

void QualityControl::forget(Seconds now) {
    if (now - settled_ < kForgotten) return;
    raise_wait_ = std::max(raise_wait_ / 2, kRaiseWait);
    settled_ = now;
}

bool QualityControl::move(std::size_t to, Seconds now) {
    demand_.windows = std::min(demand_.windows, windows_at(levels_[to], demand_));
    at_ = to;
    settled_ = calm_since_ = now;
    strained_ = 0;
    return true;
}

}  // namespace eventide::app
