// What `eventide evaluate` can be told.
#include "apps/cli/commands/evaluate_command.h"
#include "apps/cli/idle_flag.h"
#include "apps/cli/settings/time_point.h"
#include "apps/cli/settings/words.h"
#include "replay/formats.h"
#include "src/binning/slicer_settings.h"
#include "src/core/list_text.h"
#include "src/core/sensor_limits.h"
#include "src/settings/setting.h"

#include <algorithm>
#include <set>
#include <utility>

namespace eventide::app {

namespace {

Setting seconds_setting(std::string key, std::string& value, std::string help,
                        const std::string& open) {
    return parsed_setting<std::string>(
        std::move(key), value, "TIME", std::move(help),
        [open](const std::string& text) {
            if (text != open) parse_duration(text);
            return text;
        },
        [](const std::string& text) { return text; });
}

}  // namespace

std::string EvaluateCommand::examples() const {
    return "Tables go to standard output; LPIPS needs --lpips.\n"
           "Examples:\n"
           "  eventide evaluate recording.aedat4 ecd/slider_depth --json scores.json\n"
           "  eventide evaluate ECD/ --protocol evreal --lpips lpips_squeeze_v0.1.npz\n"
           "  eventide evaluate --protocol simulated --lookahead 2\n"
           "  eventide evaluate frames/ references/ --protocol folders\n"
           "  eventide evaluate --protocol simulated --figure reliability --figure spatial --plots "
           "plots/\n"
           "  eventide evaluate held_out.aedat4 --calibrated model.safetensors";
}

std::vector<Positional> EvaluateCommand::positionals() {
    return {{"INPUT",
             "Recordings with reference images; a folder of sequences (evreal); two folders of "
             "images (folders); nothing (simulated)",
             nullptr, &inputs_}};
}

// Long, because it is a list: one line per option.
SettingTable EvaluateCommand::settings() {
    SettingTable table{"evaluate", "eventide evaluate: measures of a model.", {}};
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(choice_setting("protocol", protocol_,
                       "recordings: between their reference images; evreal: ECD, MVSEC and HQF as "
                       "EVREAL does; simulated: the project's test set; folders: images against "
                       "images.",
                       kProtocolWords));
    add(path_setting("model", model_, "NAME|FILE", "As in eventide run."));
    add(text_setting(
        "lpips", lpips_, "FILE",
        "Weights of LPIPS as npz (lpips_squeeze_v0.1.npz); empty: LPIPS is left out."));
    add(whole_setting("lookahead", lookahead_, "0|1|2",
                      "Event windows after the frame's own that may be used.", 0, kMaxLookahead));
    add(parsed_setting<std::string>(
        "window", window_, "WINDOW",
        "recordings: reference (an event window between reference images), or as in eventide run.",
        [](const std::string& text) {
            if (text != "reference" && text != "model") parse_window(text);
            return text;
        },
        [](const std::string& text) { return text; }));
    add(whole_setting("skip", skip_, "N",
                      "The first N images are not scored: the state is still empty.", 0, 1000000));
    add(whole_setting(
        "frames", given_images_, "N",
        "recordings: give one image of N to the model, which corrects its frames, and "
        "score the others; 0: none.",
        0, 1000000));
    add(bayer_setting(bayer_, "recordings: as in eventide run."));
    add(seconds_setting("from", from_,
                        "recordings: score from here, after the first event; start: "
                        "all.",
                        "start"));
    add(seconds_setting("to", to_, "recordings: score until here; end: all.", "end"));
    add(choice_setting("sigma_rule", sigma_rule_, "As in eventide run.", sigma_words()));
    add(text_setting("noise_filter", noise_filter_, "model|auto|off|TIME", "As in eventide run."));
    add(text_setting("lamp_flicker", lamp_flicker_, "auto|off|TIME",
                     "recordings: as in eventide run of a camera."));
    add(choice_setting("precision", precision_, "As in eventide run.", kPrecisionWords));
    add(choice_setting("engine", engine_, "As in eventide run.", kEngineWords));
    add(whole_setting("threads", threads_, "N", "As in eventide run.", 0, kMaxThreads));
    add(self_ensemble_setting(self_ensemble_, "As in eventide run."));

    add(text_setting("images", images_, "FOLDER",
                     "simulated: photographs to draw scenes from; empty: procedural textures."));
    add(whole_setting("last_images", last_images_, "N",
                      "simulated: only the last N of them by name; 0: all.", 0, 1000000));
    add(whole_setting("sequences", sequences_, "N", "simulated: how many.", 1, 100000));
    add(whole_setting("event_windows", event_windows_, "N", "simulated: in each sequence.", 1,
                      1000000));
    add(parsed_setting<Size>("size", size_, "WxH", "simulated: sensor size in pixels.", parse_size,
                             show_size));
    add(number_setting("scale", scale_, "S", "simulated: size of the frames, times the sensor's.",
                       1, 8));
    add(whole_setting("seed", seed_, "N", "simulated: which sequences.", 0, 2147483647));

    add(path_setting("json", json_, "FILE",
                     "All measures as JSON; -: on standard output, instead of "
                     "the table."));
    add(path_setting("csv", csv_, "FILE", "A line per sequence; - as for --json."));
    add(path_setting("frame_csv", frame_csv_, "FILE", "A line per frame; - as for --json."));
    add(list_setting(
        "figure", figures_, "NAME",
        "Figures as SVG and CSV: " + list_of(figure_names()) +
            "; spatial, temporal and silence from simulated sequences of their own, instead of a "
            "table; the others beside the table, of what is evaluated."));
    add(path_setting("plots", plots_, "FOLDER", "Where figures go."));
    add(choice_setting("calibration", calibration_,
                       "What --calibrated fits: coverage (PICP80 becomes .8), cautious (in the "
                       "sequence that needs it most) or likelihood.",
                       {{CalibrationRule::coverage, "coverage"},
                        {CalibrationRule::likelihood, "likelihood"},
                        {CalibrationRule::cautious, "cautious"}}));
    add(path_setting(
        "calibrated", calibrated_, "FILE",
        "Fit one factor for sigma on what was evaluated, and write the model with it."));
    add(flag_setting("overwrite", overwrite_, "Replace files that exist."));
    input_.add_to(table);
    return table;
}

/// Which take an option; empty: all.
std::vector<EvaluateCommand::Protocol> EvaluateCommand::protocols_of(const std::string& key) {
    using enum Protocol;
    static const std::set<std::string> of_recordings{"window", "skip", "frames", "bayer",
                                                     "from",   "to",   "reorder"};
    static const std::set<std::string> of_simulated{
        "images", "last_images", "sequences", "size", "event_windows", "scale", "seed"};
    static const std::set<std::string> of_models{
        "model",        "lookahead",  "precision",     "engine",      "threads",
        "noise_filter", "sigma_rule", "self_ensemble", "calibration", "calibrated"};
    if (of_recordings.contains(key) || key.starts_with("input_")) return {recordings};
    if (of_simulated.contains(key)) return {simulated};
    if (key == "lamp_flicker") return {recordings, evreal};
    if (of_models.contains(key)) return {recordings, evreal, simulated};
    return {};
}

void EvaluateCommand::refuse_idle_flags(const FlagKeys& flags) const {
    const std::string found = evaluates()
                                  ? show_word(protocol_, kProtocolWords)
                                  : "--figure " + figures_.front() + ", which makes only figures";
    for (const std::string& key : flags) {
        const std::vector<Protocol> of = protocols_of(key);
        const auto is_of = [&](Protocol protocol) {
            return std::ranges::find(of, protocol) != of.end();
        };
        if (of.empty() || (evaluates() && is_of(protocol_)) ||
            (simulates() && is_of(Protocol::simulated)))
            continue;
        std::vector<std::string> names(of.size());
        std::ranges::transform(of, names.begin(), [](Protocol protocol) {
            return std::string{show_word(protocol, kProtocolWords)};
        });
        refuse_idle_flag(flags, key, "--protocol " + alternatives(names), found);
    }
    refuse_flags_of_other_formats(flags);
    if (calibrated_.empty()) refuse_idle_flag(flags, "calibration", "--calibrated FILE");
    refuse_idle_precision(flags, engine_, precision_);
}

void EvaluateCommand::refuse_flags_of_other_formats(const FlagKeys& flags) const {
    const auto is_of_input = [](const std::string& key) {
        return key.starts_with("input_") || key == "reorder";
    };
    if (std::ranges::none_of(flags, is_of_input) || std::ranges::any_of(inputs_, is_read_once))
        return;
    std::vector<std::string> formats;
    for (const std::string& input : inputs_)
        formats.push_back(open_recording(input, input_.options())->info().format);
    if (!formats.empty()) refuse_idle_input_flags(flags, formats);
}

}  // namespace eventide::app
