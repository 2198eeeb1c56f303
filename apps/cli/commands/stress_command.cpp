// eventide stress: hard cases through the whole pipeline.
#include "apps/cli/commands/stress_command.h"

#include "apps/cli/commands/command_files.h"
#include "apps/cli/idle_flag.h"
#include "apps/cli/printable.h"
#include "apps/cli/progress.h"
#include "apps/cli/settings/model_path.h"
#include "apps/cli/settings/words.h"
#include "apps/cli/stress/soak.h"
#include "apps/cli/stress/soak_plots.h"
#include "apps/cli/stress/stress_table.h"
#include "apps/cli/version.h"
#include "apps/evaluate/plot.h"
#include "pipeline/parallel_tbb.h"
#include "src/core/error.h"
#include "src/io/file_lock.h"
#include "src/model/model_trial.h"

#include <fnmatch.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace eventide::app {
namespace {

using stress::short_number;

/// What a case throws is its failure, not that of the others.
StressRow row_of(const stress::Case& one, const std::string& model, const stress::Bench& bench) {
    StressRow row{one.name, one.title, one.of_model ? model : "-", {}, 0};
    const auto begun = std::chrono::steady_clock::now();
    try {
        row.result = one.run(bench);
    } catch (const std::exception& error) {
        row.result.expect(false, std::string{"no error: "} + error.what());
    }
    row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    return row;
}

}  // namespace

std::string StressCommand::examples() const {
    return "Hard cases go through the whole pipeline with each model, and codes and frames are "
           "compared with double precision. Errors are relative to the larger of 1 and the map's "
           "largest "
           "number. "
           "Exit code 1 when a case fails. Long cases are cut where time is short, and say what "
           "they ran.\n"
           "Examples:\n"
           "  eventide stress\n"
           "  eventide stress --cases 'sensor-*' --models default\n"
           "  eventide stress --minutes 30 --json cases.json\n"
           "  eventide stress --instructions avx2\n"
           "  eventide stress --soak 24 --models default --plots soak/";
}

SettingTable StressCommand::settings() {
    SettingTable table{"stress", "eventide stress: hard cases against double precision.", {}};
    const auto add = [&](Setting setting) { table.settings.push_back(std::move(setting)); };
    add(text_setting("cases", cases_, "GLOB",
                     "Only cases with such names, also as '@(ONE|OTHER)'; --list shows them."));
    add(flag_setting("list", list_, "List the cases, and exit."));
    add(list_setting("models", models_, "NAME|FILE", "Models, any number of times."));
    add(number_setting(
        "minutes", minutes_, "N",
        "About how long it may take; cases of a fixed length take their time regardless.", 0.1,
        1e5));
    add(flag_setting("quick", quick_,
                     "The form that tests run: short lengths, the same on every machine."));
    add(number_setting("soak", soak_hours_, "HOURS",
                       "Instead of the cases: so many hours of stream time as fast as possible, "
                       "with pauses and bursts.",
                       0, 1e4));
    add(choice_setting("instructions", instructions_, "As in eventide bench.", kInstructionWords));
    add(whole_setting("threads", threads_, "N", "As in eventide run.", 0, kMaxThreads));
    add(path_setting("json", json_, "FILE",
                     "Also as JSON; -: on standard output, and the table on standard error."));
    add(path_setting("plots", plots_, "FOLDER",
                     "Of --soak: memory, latency and states, SVG and "
                     "CSV."));
    add(flag_setting("overwrite", overwrite_, "Replace files that exist."));
    return table;
}

void StressCommand::name_stress_files(NamedFiles& files) const {
    files.may_replace(overwrite_);
    for (const std::string& model : models_) files.reads("--models", found_model(model));
    if (!plots_.empty()) files.expect_folder("--plots", plots_);
    if (!plots_.empty())
        for (const Plot& plot : soak_plots({}))
            for (const char* extension : {".svg", ".csv"})
                files.writes("--plots", std::filesystem::path{plots_} / (plot.name + extension));
    files.writes_when_done("--json", json_);
}

std::vector<stress::Case> StressCommand::chosen() const {
    std::vector<stress::Case> chosen;
    for (stress::Case& one : stress::all_cases())
        if (fnmatch(cases_.c_str(), one.name.c_str(), FNM_EXTMATCH) == 0 &&
            (one.in_quick_form || !quick_))
            chosen.push_back(std::move(one));
    if (chosen.empty())
        throw Error(ErrorKind::usage,
                    "--cases: expected names of cases (--list shows them), found '" + cases_ +
                        "', which none has");
    return chosen;
}

stress::Budget StressCommand::budget(Program& program) const {
    const auto stopping = [&program] { return program.signals.stopping(); };
    if (quick_) return stress::Budget::quick(stopping);
    return stress::Budget::minutes(minutes_ / double(models_.size()), stopping);
}

int StressCommand::run(Program& program) {
    if (list_) {
        for (const stress::Case& one : chosen())
            std::printf("%-18s %s\n", one.name.c_str(), one.title.c_str());
        return exit_done;
    }
    require_some("--models", models_);
    if (soak_hours_ <= 0 && !plots_.empty())
        throw Error(ErrorKind::usage, "--plots " + plots_ + ": expected --soak HOURS, found none");
    if (soak_hours_ > 0)
        for (const char* key : {"cases", "quick", "minutes"})
            refuse_idle_flag(program.flags, key, "no --soak, which runs no cases",
                             short_number(soak_hours_) + " h");
    if (quick_) refuse_idle_flag(program.flags, "minutes", "no --quick", "both");
    name_stress_files(program.files);
    return soak_hours_ > 0 ? run_soak(program) : run_cases(program);
}

namespace {

EngineOptions engine_with(int threads, Instructions instructions) {
    EngineOptions engine;
    engine.precision = Precision::f32;
    engine.kernels = Kernels::own;
    engine.instructions = instructions;
    engine.parallel_for = parallel_for_with(threads);
    return engine;
}

/// Some of the cases say nothing of all.
void refuse_partial(Program& program) {
    if (program.signals.stopping())
        throw Error(ErrorKind::failed, "stress: stopped before all cases had run");
}

Model load_tried(const std::string& name) {
    const std::filesystem::path file = find_model(name);
    Model model = load_model(file);
    try_model(model, file.string());
    return model;
}

}  // namespace

int StressCommand::run_cases(Program& program) {
    const std::vector<stress::Case> cases = chosen();
    std::vector<Model> models;
    for (const std::string& name : models_) models.push_back(load_tried(name));
    std::FILE* const table = table_beside(json_);
    std::fprintf(table, "%s; eventide %s, %s\n\n", processor_text().c_str(), version().c_str(),
                 compiler_text().c_str());
    print_stress_head(table);
    Progress progress{program.quiet};
    std::vector<StressRow> rows;
    for (std::size_t c = 0; c < cases.size() && !program.signals.stopping(); ++c)
        for (std::size_t m = 0; m < (cases[c].of_model ? models.size() : 1); ++m) {
            progress.show(double(c) / double(cases.size()), cases[c].title + ", " + models_[m]);
            StressRow row =
                row_of(cases[c], models_[m],
                       {models[m], engine_with(threads_, instructions_), budget(program)});
            progress.clear();
            if (program.signals.stopping()) break;  // it did not come to its end
            print_stress_row(row, table);
            rows.push_back(std::move(row));
        }
    refuse_partial(program);
    write_result(json_, json_text(stress_json(rows)) + "\n", overwrite_, program.signals);
    const auto failed =
        std::ranges::count_if(rows, [](const StressRow& row) { return !row.result.passed; });
    const auto left_out =
        std::ranges::count_if(rows, [](const StressRow& row) { return !row.result.ran; });
    std::fprintf(table, "\n%zu rows, %zu failed, %zu not run\n", rows.size(), std::size_t(failed),
                 std::size_t(left_out));
    return failed == 0 ? exit_done : int(ErrorKind::failed);
}

int StressCommand::run_soak(Program& program) {
    if (models_.size() != 1 && !plots_.empty())
        throw Error(ErrorKind::usage,
                    "--soak with --plots: expected one model (--models NAME), "
                    "found " +
                        std::to_string(models_.size()));
    FolderLock plots;
    if (!plots_.empty()) plots.take(plots_);
    std::FILE* const table = table_beside(json_);
    std::fprintf(table, "%s; eventide %s, %s\n\n", processor_text().c_str(), version().c_str(),
                 compiler_text().c_str());
    print_stress_head(table);
    std::vector<StressRow> rows;
    Progress progress{program.quiet};
    for (const std::string& name : models_) {
        stress::SoakSettings settings;
        settings.hours = soak_hours_;
        settings.stopping = [&] { return program.signals.stopping(); };
        settings.on_sample = [&](const stress::SoakSample& sample) {
            progress.show(sample.stream_hours / soak_hours_, name);
        };
        const auto samples =
            stress::soak(load_tried(name), engine_with(threads_, instructions_), settings);
        progress.clear();
        rows.push_back({"soak", short_number(soak_hours_) + " h of pauses and bursts", name,
                        stress::soak_verdict(samples), 0});
        print_stress_row(rows.back(), table);
        if (plots_.empty()) continue;
        for (const Plot& plot : soak_plots(samples))
            spdlog::info("{}", write_plot(plot, plots_, overwrite_).string());
    }
    refuse_partial(program);
    write_result(json_, json_text(stress_json(rows)) + "\n", overwrite_, program.signals);
    const bool passed =
        std::ranges::all_of(rows, [](const StressRow& row) { return row.result.passed; });
    return passed ? exit_done : int(ErrorKind::failed);
}

}  // namespace eventide::app
