// Which quality a run has, as people and programs read it.
#include "apps/cli/run/quality/quality_report.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>

namespace eventide::app {

namespace {

using Json = nlohmann::ordered_json;

std::string rounded(double value) {
    char text[32];
    std::snprintf(text, sizeof text, value < 1000 ? "%.3g" : "%.0f", value);
    return text;
}

double thousandths(double value) {
    return std::round(value * 1000) / 1000;
}

double rate_of(const QualityLevel& level, double frames_per_second) {
    return frames_per_second / double(1U << level.halvings);
}

double ms_of(SensorDuration duration) {
    return double(duration.count()) / 1e3;
}

Json json_of(const QualityLevel& level, double frames_per_second) {
    return {{"scale", level.scale},
            {"frames_per_second", rate_of(level, frames_per_second)},
            {"min_window_ms",
             level.min_window.count() > 0 ? Json(ms_of(level.min_window)) : Json(nullptr)}};
}

/// Whether `to` is further down than `from`.
bool is_lower(const QualityLevel& to, const QualityLevel& from) {
    if (to.scale != from.scale) return to.scale < from.scale;
    if (to.halvings != from.halvings) return to.halvings > from.halvings;
    return to.min_window > from.min_window;
}

Json json_of(const NetworkLoad& load) {
    return {{"encode", thousandths(load.encode)}, {"frames", thousandths(load.frames)}};
}

}  // namespace

std::string level_text(const QualityLevel& level, double frames_per_second) {
    const std::string scale = rounded(level.scale) + "x ";
    if (frames_per_second <= 0) return scale + "a frame per event window";
    const std::string rate = rounded(rate_of(level, frames_per_second)) + " frames/s";
    if (level.min_window.count() == 0) return scale + rate;
    return scale + rate + ", event windows of " + rounded(ms_of(level.min_window)) + " ms or more";
}

std::string choice_text(const QualityState& state) {
    return state.model + ", " + state.precision + ", " +
           level_text(state.level, state.frames_per_second) + ": " + rounded(state.load.total()) +
           " cores by its profile (encoding " + rounded(state.load.encode) + ", frames " +
           rounded(state.load.frames) + "), of " + rounded(state.affordable) +
           (state.budget == "none" ? "" : " (--budget " + state.budget + ")");
}

std::string change_text(const QualityChange& change, double frames_per_second) {
    return std::string{"quality "} + (is_lower(change.to, change.from) ? "lowered" : "raised") +
           " from " + level_text(change.from, frames_per_second) + " to " +
           level_text(change.to, frames_per_second) + ": encoding took " +
           rounded(change.load.encode) + " of its thread, frames " + rounded(change.load.frames);
}

Json quality_json(const QualityState& state, bool all) {
    Json json{{"mode", !state.chosen      ? "fixed"
                       : state.taken_over ? "viewer"
                                          : "auto"},
              {"model", state.model},
              {"precision", state.precision}};
    json.update(json_of(state.level, state.frames_per_second));
    if (!state.chosen) return json;
    json["load"] = json_of(state.load);
    json["changes"] = state.changes;
    if (!all) return json;
    json["holds"] = state.holds;
    json["affordable"] = thousandths(state.affordable);
    json["budget"] = state.budget;
    json["threads"] = state.threads;
    json["profile"] = state.profile.empty() ? Json(nullptr) : Json(state.profile);
    json["measured"] = state.measured;
    json["newest_changes"] = Json::array();
    for (const QualityChange& change : state.newest)
        json["newest_changes"].push_back({{"at_s", thousandths(change.at.count())},
                                          {"from", json_of(change.from, state.frames_per_second)},
                                          {"to", json_of(change.to, state.frames_per_second)},
                                          {"load", json_of(change.load)}});
    return json;
}

}  // namespace eventide::app
