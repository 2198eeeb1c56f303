// The quality of one run.
#include "apps/cli/run/quality/run_quality.h"

#include "apps/cli/printable.h"
#include "apps/cli/run/live_controls.h"
#include "apps/cli/run/quality/measure_profile.h"
#include "apps/cli/run/quality/open_settings.h"
#include "apps/cli/run/quality/profile_cache.h"
#include "apps/cli/settings/model_path.h"
#include "apps/cli/settings/words.h"
#include "pipeline/parallel_tbb.h"
#include "src/model/model_file.h"
#include "src/model/model_folders.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace eventide::app {

namespace {

constexpr std::size_t kChangesKept = 100;

double threads_of(const RunSettings& settings) {
    const int usable = usable_threads();
    return settings.threads == 0 ? usable : std::min(usable, settings.threads);
}

std::vector<PrecisionCost> costs_to_choose_from(const QualityProfile& profile,
                                                const RunSettings& settings) {
    const PrecisionCost* asked = profile.of(settings.precision);
    auto costs = asked == nullptr ? profile.costs : std::vector<PrecisionCost>{*asked};
    for (PrecisionCost& cost : costs)
        for (double* ms :
             {&cost.encode_ms, &cost.first_ms, &cost.full_ms, &cost.half_ms, &cost.third_ms})
            *ms *= settings.self_ensemble;
    return costs;
}

CachedProfile profile_of(const std::string& name, const Model& model, const RunSettings& settings,
                         const SensorInfo& sensor, const std::function<bool()>& give_up) {
    const ProfileKey key = profile_key(name, model, sensor.width, sensor.height, settings.kernels);
    CachedProfile found = cached_profile(cache_folder(), key, [&] {
        spdlog::info("measuring what this processor does with {} at {}x{}, once", printable(name),
                     sensor.width, sensor.height);
        return measure_profile(key, model, {settings.kernels, MeasureSettings{}.time, give_up});
    });
    spdlog::debug("profile of {}: {}", printable(name), printable(found.file.string()));
    return found;
}

}  // namespace

/// What came out, with what it came from.
struct RunQuality::Chosen {
    std::string model;
    QualityChoice choice;
    std::vector<PrecisionCost> costs;  // of the model
    QualityDemand demand;
    QualityLevel asked;
    std::optional<SlicerSettings> slicer;  // windows by content
    CachedProfile profile;

    std::vector<QualityLevel> levels(const QualityLevel& best, bool rate, bool scale) const {
        if (!slicer) return quality_levels(best, rate, scale);
        return quality_levels(best, rate, scale, min_windows(slicer->max_width));
    }
};

RunQuality::RunQuality(RunSettings& settings, const Place& place,
                       const std::function<bool()>& give_up)
    : sensor_{place.sensor.width, place.sensor.height} {
    state_.model = settings.model;
    state_.precision = show_word(settings.precision, kPrecisionWords);
    state_.level = asked_level(settings, place.sensor);
    state_.chosen = place.chooses;
    state_.budget = show_budget(settings.budget);
    if (!place.chooses) return;
    const Chosen chosen = choose(settings, place, give_up);
    settings.model = state_.model = chosen.model;
    settings.precision = chosen.choice.precision;
    state_.precision = show_word(settings.precision, kPrecisionWords);
    state_.level = chosen.choice.level;
    if (scale_is_open(settings)) settings.size.scale = state_.level.scale;
    if (chosen.slicer) {
        slicer_ = *chosen.slicer;
        slicer_.min_width = state_.level.min_window;
        settings.window = window_text(slicer_);
    }
    if (chosen.demand.share && settings.threads == 0) settings.threads = int(chosen.demand.threads);
    state_.holds = chosen.choice.holds;
    state_.load = chosen.choice.load;
    state_.affordable = affordable_load(chosen.demand);
    state_.threads = chosen.demand.threads;
    state_.profile = chosen.profile.file.string();
    state_.measured = chosen.profile.measured;
    state_.frames_per_second = video_rate(settings);
    begin_control(settings, chosen);
    say();
}

QualityDemand RunQuality::demand_of(const RunSettings& settings, const Place& place,
                                    const SlicerSettings& slicer) const {
    constexpr double kWindowsByContent = 20;  // until it is known how much moves
    QualityDemand demand;
    demand.pace = place.pace;
    demand.windows =
        place.pace * (slicer.rule == WindowRule::duration ? 1e6 / double(slicer.width.count())
                                                          : kWindowsByContent);
    const FrameRate rate = rate_of(settings, slicer);
    demand.frames =
        rate.is_set() ? place.pace * double(rate.frames) / double(rate.seconds) : demand.windows;
    demand.threads = threads_of(settings);
    demand.share = settings.budget.cores(demand.frames);
    if (demand.share && settings.threads == 0)
        demand.threads = std::clamp(std::ceil(*demand.share), 1.0, demand.threads);
    return demand;
}

/// The next model is looked at only where none of the levels of the one before holds.
RunQuality::Chosen RunQuality::choose(RunSettings& settings, const Place& place,
                                      const std::function<bool()>& give_up) {
    const QualityLevel asked = asked_level(settings, place.sensor);
    std::optional<Chosen> least;
    for (const std::string& name : models_to_choose_from(settings)) {
        if (least && found_model(name).empty()) continue;  // the first must be there
        const Model model = load_model(find_model(name));
        CachedProfile profile = profile_of(name, model, settings, place.sensor, give_up);
        const SlicerSettings usual = slicer_of(settings, model.config, place.span, place.as_live);
        Chosen chosen{name,
                      {},
                      costs_to_choose_from(profile.profile, settings),
                      demand_of(settings, place, usual),
                      asked,
                      windows_by_content(settings, usual),
                      std::move(profile)};
        const auto levels = chosen.levels(asked, rate_is_open(settings), scale_is_open(settings));
        const auto best = best_that_holds(chosen.costs, levels, chosen.demand);
        chosen.choice = best ? *best : least_load(chosen.costs, levels, chosen.demand);
        if (best || !least || chosen.choice.load.total() < least->choice.load.total())
            least = std::move(chosen);
        if (best) break;
    }
    return std::move(*least);
}

/// Streams and files keep the size they began with; of their frames some can be left out.
void RunQuality::begin_control(const RunSettings& settings, const Chosen& chosen) {
    const bool scale = scale_is_open(settings) && !rigid_sink(settings),
               rate = rate_is_open(settings);
    if (!scale && !rate && !chosen.slicer) return;
    QualityLevel best = chosen.asked;
    if (!scale) best.scale = state_.level.scale;
    const auto levels = chosen.levels(best, rate, scale);
    const auto at = std::ranges::find(levels, state_.level);
    const auto cost =
        std::ranges::find(chosen.costs, chosen.choice.precision, &PrecisionCost::precision);
    control_.emplace(*cost, levels, std::size_t(at - levels.begin()), chosen.demand);
}

void RunQuality::say() const {
    if (state_.holds)
        spdlog::info("quality: {}", choice_text(state_));
    else
        spdlog::warn(
            "quality: the pace cannot be held with what is left open; {}. Frames will be left out",
            choice_text(state_));
}

void RunQuality::look(const Snapshot& now, std::chrono::duration<double> elapsed, double pace,
                      LiveChanges& changes) {
    const std::lock_guard lock{mutex_};
    if (!control_ || state_.taken_over) return;
    const QualityLevel before = control_->level();
    const bool changed =
        control_->look({elapsed, now.encoded, now.merged_windows, now.frames, now.encode.total,
                        now.render.total + now.write.total, now.take.total, pace});
    const NetworkLoad load = control_->measured();
    state_.load = load;
    if (!changed) return;
    state_.level = control_->level();
    const QualityChange change{elapsed, before, state_.level, load};
    ++state_.changes;
    state_.newest.push_back(change);
    if (state_.newest.size() > kChangesKept) state_.newest.erase(state_.newest.begin());
    if (before.scale != state_.level.scale)
        changes.set_size(std::max(1, int(std::lround(sensor_.width * state_.level.scale))),
                         std::max(1, int(std::lround(sensor_.height * state_.level.scale))));
    changes.set_halvings(state_.level.halvings);
    if (before.min_window != state_.level.min_window) {
        slicer_.min_width = state_.level.min_window;
        changes.set_window(slicer_);
    }
    spdlog::info("{}", change_text(change, state_.frames_per_second));
}

void RunQuality::take_over(LiveChanges& changes) {
    const std::lock_guard lock{mutex_};
    if (!control_ || state_.taken_over) return;
    state_.taken_over = true;
    state_.level.halvings = 0;
    changes.set_halvings(0);
    spdlog::info(
        "quality: a viewer has set rate, scale or event window; it is not changed any more");
}

void RunQuality::tell_rate(double frames_per_second) {
    const std::lock_guard lock{mutex_};
    state_.frames_per_second = frames_per_second;
}

void RunQuality::tell_scale(double scale) {
    const std::lock_guard lock{mutex_};
    state_.level.scale = scale;
}

void RunQuality::follow(std::vector<HttpControl>& controls, LiveChanges& changes) {
    for (HttpControl& control : controls) {
        const bool scale = control.name == "scale", rate = control.name == "fps";
        if (!control.set || (!rate && !scale && control.name != "window")) continue;
        control.set = [this, &changes, scale, rate, set = std::move(control.set)](double wanted) {
            take_over(changes);
            set(wanted);
            if (scale) tell_scale(wanted);
            if (rate) tell_rate(wanted);
        };
        if (scale)
            control.get = [this, get = std::move(control.get)] {
                const QualityState now = state();
                return now.chosen ? now.level.scale : get();
            };
    }
}

QualityState RunQuality::state() const {
    const std::lock_guard lock{mutex_};
    return state_;
}

}  // namespace eventide::app
