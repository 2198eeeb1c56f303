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
#include "src/io/file_lock.h"

#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdio>

namespace eventide::app {

namespace {

std::string case_name(const std::string& model, const std::string& precision,
                      const std::string& size) {
    return model + " " + precision + " " + size;
}

/// Some of the rows would be taken for all.
void refuse_partial(Program& program) {
    if (program.signals.stopping())
        throw Error(ErrorKind::failed, "bench: stopped before everything was measured");
}

}  // namespace

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
    FolderLock folder;
    for (const std::string& made : {report_, plots_})  // at most one of them
        if (!made.empty()) folder.take(made);
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
