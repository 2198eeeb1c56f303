// What eventide bench is asked for, and whether it can be measured.
#include "apps/cli/bench/report.h"
#include "apps/cli/commands/bench_command.h"
#include "apps/cli/settings/model_path.h"
#include "apps/cli/settings/words.h"
#include "src/core/error.h"
#include "src/simulate/presets.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace eventide::app {

namespace {

/// Each is tried before anything is measured.
template <typename Parse>
void check_list(const char* option, const std::vector<std::string>& texts, const Parse& parse) {
    require_some(option, texts);
    try {
        for (const std::string& text : texts) parse(text);
    } catch (const Error& error) {
        throw Error(error.kind(), std::string{option} + ": " + error.what());
    }
}

void refuse_beside(const std::string& option, const std::string& value, const std::string& other) {
    if (!value.empty())
        throw Error(ErrorKind::usage, option + " " + value + ": expected no " + other);
}

void expect_report(const std::string& option, const std::string& value) {
    if (!value.empty())
        throw Error(ErrorKind::usage,
                    option + " " + value + ": expected --report FOLDER, found none");
}

}  // namespace

std::string BenchCommand::examples() const {
    return "First the stages alone, one thread, nothing beside them, everything moving: median "
           "and quartiles of processor time; share: useful products a second over the core's own "
           "peak, of encoding, a fresh frame, another frame of the same window. Then the "
           "pipeline. ms/window: the network per event window of 50 ms, ms/frame: rendering one "
           "frame (medians); x real: sensor time over host time as fast as possible; latency at "
           "the pace of the camera, from the last packet a frame saw to the frame written.\n"
           "Examples:\n"
           "  eventide bench\n"
           "  eventide bench --stages --sizes 240x180 --lookahead 0\n"
           "  eventide bench --sizes 240x180 --models default --models small --precisions f32 "
           "--precisions bf16\n"
           "  eventide bench --instructions avx2\n"
           "  eventide bench --report report/ --lookahead 0 --models default --models small";
}

SettingTable BenchCommand::settings() {
    SettingTable table{"bench", "eventide bench: speed against error.", {}};
    add_measured(table);
    add_outputs(table);
    return table;
}

void BenchCommand::add_measured(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(text_setting("scene", settings_.scene, "NAME", "Scene of the simulated recordings."));
    add(list_setting("sizes", settings_.sizes, "WxH", "Sensor sizes, any number of times."));
    add(list_setting("models", settings_.models, "NAME|FILE", "Models, any number of times."));
    add(list_setting("precisions", settings_.precisions, "P",
                     "auto, f32 or bf16, any number of times."));
    add(choice_setting("engine", settings_.engine, "As in eventide run.", kEngineWords));
    add(choice_setting("instructions", settings_.instructions,
                       "What the kernels may use: best (all the processor has), or no more than "
                       "an older one; avx512: all but AMX.",
                       kInstructionWords));
    add(number_setting("seconds", settings_.seconds, "S", "Duration of each recording, seconds.",
                       0.2, 3600));
    add(number_setting("scale", settings_.scale, "S", "Size of the frames, times the sensor's.",
                       0.1, 16));
    add(whole_setting("lookahead", settings_.lookahead, "0|1|2", "As in eventide run.", 0,
                      kMaxLookahead));
    add(whole_setting("threads", settings_.threads, "N", "As in eventide run.", 0, kMaxThreads));
    add(flag_setting("stages", stages_, "The stages alone, without the pipeline after them."));
    add(flag_setting("activity", activity_,
                     "Cost and error when 0, 1, 5, 25 and 100 % of the scene moves, without the "
                     "pipeline."));
    add(number_setting(
        "still_codes", settings_.still_codes, "D",
        "With --activity or --report, frames at changing places in the window: a part whose "
        "codes changed by no more than this is copied.",
        0, 100));
    add(number_setting("still_time", settings_.still_time, "WINDOWS",
                       "With --activity or --report: how far the place in the window may be from "
                       "the one it is copied from.",
                       0, 1));
    add(whole_setting("repetitions", settings_.repetitions, "N", "Of each stage.",
                      bench::kLeastRepetitions, 1'000'000));
}

void BenchCommand::add_outputs(SettingTable& table) {
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(path_setting("json", json_, "FILE",
                     "Also as JSON; -: on standard output, and the table on standard error."));
    add(path_setting("plots", plots_, "FOLDER", "Also as a plot, SVG and CSV."));
    add(path_setting("report", report_, "FOLDER",
                     "Instead of all this: a page, index.html, of speed against error for models, "
                     "arithmetic and lengths of event windows, frame rate, activity, latency by "
                     "rate of events, and memory, with its plots and JSON; minutes, of --sizes, "
                     "--models, --precisions and --seconds."));
    add(text_setting("lpips", settings_.lpips, "FILE",
                     "With --report: LPIPS weights, as in evaluate."));
    add(path_setting("peers", peers_, "FILE",
                     "With --report: other networks, as bench_peers --table measured them."));
    add(flag_setting("overwrite", overwrite_, "Replace files that exist."));
}

/// What is asked for can be measured, and what is measured shown.
void BenchCommand::check_settings() const {
    simulation_preset(settings_.scene);
    check_list("--sizes", settings_.sizes, parse_size);
    check_list("--precisions", settings_.precisions,
               [](const std::string& text) { return parse_word(text, kPrecisionWords); });
    require_some("--models", settings_.models);
    if (!report_.empty()) {
        refuse_beside("--json", json_, "--report, which has its own report.json");
        refuse_beside("--plots", plots_, "--report, which has its own plots");
        if (stages_ || activity_)
            throw Error(ErrorKind::usage, std::string{stages_ ? "--stages" : "--activity"} +
                                              ": expected no --report, which has both");
        if (settings_.scale != 1)
            throw Error(ErrorKind::usage,
                        "--report " + report_ +
                            ": its frames are compared with images of the sensor's size; expected "
                            "--scale 1, found " +
                            show_number(settings_.scale));
    } else {
        expect_report("--peers", peers_);
        expect_report("--lpips", settings_.lpips);
    }
    if (stages_) refuse_beside("--plots", plots_, "--stages, as the plot is of the pipeline");
    if (activity_) refuse_beside("--plots", plots_, "--activity, as the plot is of the pipeline");
}

void BenchCommand::name_bench_files(NamedFiles& files) const {
    files.may_replace(overwrite_);
    for (const std::string& model : settings_.models) files.reads("--models", find_model(model));
    files.reads("--lpips", settings_.lpips);
    files.reads("--peers", peers_);
    if (!report_.empty()) files.expect_folder("--report", report_);
    if (!plots_.empty()) files.expect_folder("--plots", plots_);
    if (!report_.empty())
        for (const std::filesystem::path& name : report_files())
            files.writes("--report", std::filesystem::path{report_} / name);
    if (!plots_.empty())
        for (const char* name : {"bench.svg", "bench.csv"})
            files.writes("--plots", std::filesystem::path{plots_} / name);
    files.writes_when_done("--json", json_);
}

}  // namespace eventide::app
