// eventide bench: the pipeline on simulated recordings of several sizes, against their truth.
#include "apps/cli/commands/bench_command.h"

#include "apps/bench/stage_table.h"
#include "apps/cli/bench/bench_table.h"
#include "apps/cli/bench/report.h"
#include "apps/cli/commands/command_files.h"
#include "apps/cli/idle_flag.h"
#include "apps/cli/printable.h"
#include "apps/cli/progress.h"
#include "apps/cli/settings/model_path.h"
#include "apps/cli/settings/words.h"
#include "apps/cli/version.h"
#include "src/core/error.h"
#include "src/simulate/presets.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdio>

namespace eventide::app {

namespace {

std::string case_name(const std::string& model, const std::string& precision,
                      const std::string& size) {
    return model + " " + precision + " " + size;
}

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

/// Some of the rows would be taken for all.
void refuse_partial(Program& program) {
    if (program.signals.stopping())
        throw Error(ErrorKind::failed, "bench: stopped before everything was measured");
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

BenchRow BenchCommand::measure(const std::shared_ptr<const RecordedPackets>& data,
                               const std::string& model, Precision precision,
                               Program& program) const {
    PipelineBenchSettings settings = settings_.pipeline(model, precision);
    const PipelineBench free = measure_pipeline(data, settings, program.signals);
    settings.lookahead = 0;
    settings.speed = 1;
    const PipelineBench live = measure_pipeline(data, settings, program.signals);
    return {.model = free.model,
            .engine = free.engine,
            .sensor = free.sensor,
            .event_rate = double(free.counters.events) / settings_.seconds,
            .encode_ms = milliseconds(free.counters.encode.p50),
            .render_ms = milliseconds(free.counters.render.p50),
            .times_real_time = settings_.seconds / free.seconds,
            .latency_p50_ms = milliseconds(live.counters.latency.p50),
            .latency_p99_ms = milliseconds(live.counters.latency.p99),
            .mse = free.error.frames > 0 ? free.error.raw.mse : std::nan("")};
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

template <typename Measure>
void BenchCommand::for_each_stage(const std::string& what, Program& program,
                                  const Measure& measure) const {
    constexpr int kWindows = 6;
    Progress progress{program.quiet};
    for (const std::string& text : settings_.sizes) {
        const Size size = parse_size(text);
        progress.show(0, "simulating " + text);
        const auto windows = bench::scene_windows(recording_of(settings_.scene, size), kWindows);
        for (const std::string& name : settings_.models)
            for (const std::string& precision : settings_.precisions) {
                if (program.signals.stopping()) return;
                progress.show(0, what + " of " + case_name(name, precision, text));
                const std::filesystem::path file = find_model(name);
                const bench::StageSettings settings =
                    settings_.stage(size, parse_word(precision, kPrecisionWords));
                measure(printable(file.stem().string()), load_model(file), windows, settings);
            }
    }
}

std::vector<bench::StageRow> BenchCommand::measure_stages(const bench::Peaks& peaks,
                                                          Program& program) const {
    std::vector<bench::StageRow> rows;
    for_each_stage(
        "stages", program,
        [&](const auto& name, const auto& model, const auto& windows, const auto& settings) {
            rows.push_back(bench::measure_stages(name, model, windows, settings, peaks));
        });
    return rows;
}

std::vector<bench::ActivityRow> BenchCommand::measure_activity(Program& program) const {
    std::vector<bench::ActivityRow> rows;
    for_each_stage(
        "activity", program,
        [&](const auto& name, const auto& model, const auto& windows, const auto& settings) {
            const auto more =
                bench::measure_activity(name, model, windows, settings, {0, .01, .05, .25, 1});
            rows.insert(rows.end(), more.begin(), more.end());
        });
    return rows;
}

std::vector<BenchRow> BenchCommand::measure_pipelines(Program& program) const {
    std::vector<BenchRow> rows;
    Progress progress{program.quiet};
    for (const std::string& size : settings_.sizes) {
        progress.show(0, "simulating " + size);
        const auto data = simulated_packets(settings_.scene, parse_size(size), settings_.seconds);
        for (const std::string& model : settings_.models)
            for (const std::string& precision : settings_.precisions) {
                if (program.signals.stopping()) return rows;
                progress.show(0, case_name(model, precision, size));
                rows.push_back(
                    measure(data, model, parse_word(precision, kPrecisionWords), program));
            }
    }
    return rows;
}

int BenchCommand::report(Program& program) const {
    const Report measured = measure_report(settings_, read_peers(peers_), program);
    refuse_partial(program);
    write_report(measured, report_, overwrite_);
    spdlog::info("{}", (std::filesystem::path{report_} / "index.html").string());
    return exit_done;
}

int BenchCommand::run(Program& program) {
    check_settings();
    if (!activity_ && report_.empty())
        for (const char* key : {"still_codes", "still_time"})
            refuse_idle_flag(program.flags, key, "--activity or --report FOLDER");
    name_bench_files(program.files);
    if (!report_.empty()) return report(program);
    std::FILE* const table = table_beside(json_);
    std::fprintf(table, "%s; eventide %s, %s; scene %s, lookahead %d\n", processor_text().c_str(),
                 version().c_str(), compiler_text().c_str(), settings_.scene.c_str(),
                 settings_.lookahead);
    const bench::Peaks peaks = bench::measure_peaks(settings_.instructions);
    std::fputs(bench::peaks_text(peaks).c_str(), table);
    std::vector<bench::StageRow> stages;
    std::vector<bench::ActivityRow> activity;
    std::vector<BenchRow> rows;
    if (activity_) {
        std::fprintf(
            table,
            "anywhere: frames at changing places in the window; copied where codes changed "
            "by at most %g and the place by %g windows\n",
            settings_.still_codes, settings_.still_time);
        activity = measure_activity(program);
        std::fputs(bench::activity_text(activity).c_str(), table);
    }
    if (stages_ || !activity_) {
        stages = measure_stages(peaks, program);
        std::fputs(bench::stages_text(stages).c_str(), table);
    }
    refuse_partial(program);
    if (!stages_ && !activity_) {
        std::fprintf(table, "\nthe pipeline: threads %s, %g s, latency at lookahead 0\n",
                     settings_.threads == 0 ? "all" : std::to_string(settings_.threads).c_str(),
                     settings_.seconds);
        rows = measure_pipelines(program);
        print_bench_table(rows, table);
    }
    refuse_partial(program);
    write_result(json_, bench_json(stages, activity, peaks, rows), overwrite_, program.signals);
    if (!plots_.empty())
        spdlog::info("{}", write_plot(bench_plot(rows), plots_, overwrite_).string());
    return exit_done;
}

}  // namespace eventide::app
