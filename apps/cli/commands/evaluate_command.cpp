// eventide evaluate: how good a model's frames and sigma are.
#include "apps/cli/commands/evaluate_command.h"

#include "apps/cli/commands/command_files.h"
#include "apps/cli/printable.h"
#include "apps/cli/progress.h"
#include "apps/cli/settings/model_path.h"
#include "pipeline/parallel_tbb.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/file_lock.h"
#include "src/io/output_paths.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <memory>
#include <utility>

namespace eventide::app {

namespace {

std::optional<double> seconds_of(const std::string& text, const char* open) {
    if (text == open) return std::nullopt;
    return std::chrono::duration<double>(parse_duration(text)).count();
}

}  // namespace

EvaluateSettings EvaluateCommand::how(Program& program) const {
    EvaluateSettings how;
    if (protocol_ != Protocol::folders) how.model = find_model(model_);
    how.lpips = lpips_;
    how.lookahead = lookahead_;
    how.sigma_rule = sigma_rule_;
    how.engine.engine = engine_;
    how.noise_filter = noise_filter_;
    how.lamp_flicker = lamp_flicker_;
    how.engine.precision = precision_;
    how.engine.parallel_for = parallel_for_with(threads_);
    how.engine.self_ensemble = self_ensemble_;
    // Of recordings each is long: they come one by one, and the network takes all threads.
    if (protocol_ == Protocol::simulated) how.parallel_for = how.engine.parallel_for;
    how.warn = [](const std::string& text) { spdlog::warn("{}", printable(text)); };
    how.progress = [progress = std::make_shared<Progress>(program.quiet),
                    &signals = program.signals](const std::string& sequence, double share) {
        progress->show(share, sequence);
        if (share >= 1) progress->clear();
        if (signals.stopping()) throw Error(ErrorKind::failed, "stopped before the end");
    };
    return how;
}

SimulatedSettings EvaluateCommand::simulated() const {
    SimulatedSettings what;
    what.images = images_;
    what.last_images = last_images_;
    what.sequences = sequences_;
    what.event_windows = event_windows_;
    what.width = size_.width;
    what.height = size_.height;
    what.scale = scale_;
    what.seed = std::uint64_t(seed_);
    return what;
}

void EvaluateCommand::require_inputs() const {
    if (!evaluates() && !inputs_.empty())
        throw Error(ErrorKind::usage, "evaluate: expected no input, found " + inputs_.front() +
                                          "; --figure " + figures_.front() +
                                          " is made of simulated sequences of its own");
    if (!evaluates()) return;
    const std::size_t n = inputs_.size();
    const char* expected = nullptr;
    if (protocol_ == Protocol::recordings && n < 1) expected = "one or more recordings";
    if (protocol_ == Protocol::evreal && n != 1) expected = "one folder";
    if (protocol_ == Protocol::folders && n != 2)
        expected = "two folders: images and what they are to be";
    if (protocol_ == Protocol::simulated && n != 0) expected = "no input";
    if (expected != nullptr)
        throw Error(ErrorKind::usage,
                    std::string{"evaluate: expected "} + expected + ", found " + std::to_string(n));
    if (protocol_ == Protocol::recordings) std::ranges::for_each(inputs_, refuse_camera);
}

void EvaluateCommand::require_figures_that_fit() const {
    std::ranges::for_each(figures_, require_figure);
    if (figures_.empty() && plots_ != kPlots)
        throw Error(ErrorKind::usage, "--plots " + plots_ + ": expected --figure NAME, found none");
    if (!figures_.empty() && protocol_ == Protocol::folders)
        throw Error(ErrorKind::usage, "--figure " + figures_.front() +
                                          ": expected an evaluation of a model, found --protocol "
                                          "folders");
    if (lpips_.empty() && std::ranges::count(figures_, "patch-size") > 0)
        throw Error(ErrorKind::usage, "--figure patch-size: expected --lpips FILE, found none");
}

void EvaluateCommand::require_outputs_that_fit() const {
    if (!calibrated_.empty() && given_images_ > 0)
        throw Error(ErrorKind::usage,
                    "--calibrated " + calibrated_ +
                        ": a factor found on frames that images corrected is not the model's; "
                        "expected --frames 0, found " +
                        std::to_string(given_images_));
    if (evaluates()) return;
    for (const auto& [option, file] : {std::pair{"--json ", &json_},
                                       {"--csv ", &csv_},
                                       {"--frame-csv ", &frame_csv_},
                                       {"--calibrated ", &calibrated_}})
        if (!file->empty())
            throw Error(ErrorKind::usage, option + *file +
                                              ": expected an evaluation, found --figure " +
                                              figures_.front() + ", which makes only figures");
}

/// Some figures are runs of their own, and need nothing else.
bool EvaluateCommand::evaluates() const {
    return figures_.empty() || std::ranges::any_of(figures_, is_report_figure);
}

bool EvaluateCommand::simulates() const {
    return (evaluates() && protocol_ == Protocol::simulated) ||
           !std::ranges::all_of(figures_, is_report_figure);
}

EvaluateReport EvaluateCommand::evaluate(const EvaluateSettings& how) const {
    switch (protocol_) {
        case Protocol::evreal:
            return evaluate_evreal(inputs_[0], how);
        case Protocol::simulated:
            return evaluate_simulated(simulated(), how);
        case Protocol::folders:
            return evaluate_folders(inputs_[0], inputs_[1], lpips_, how.warn);
        case Protocol::recordings:
            break;
    }
    RecordingSettings what;
    what.recordings.assign(inputs_.begin(), inputs_.end());
    what.window = window_;
    what.skip_images = skip_;
    if (given_images_ == 1)
        throw Error(
            ErrorKind::usage,
            "--frames 1: all images would be given and none scored; expected 0, or 2 or more");
    what.given_images = given_images_;
    what.input = input_.options();
    what.bayer = bayer_;
    what.from_s = seconds_of(from_, "start");
    what.to_s = seconds_of(to_, "end");
    return evaluate_recordings(what, how);
}

void EvaluateCommand::write_plots(const std::vector<Plot>& plots) const {
    for (const Plot& plot : plots)
        spdlog::info("{}", write_plot(plot, plots_, overwrite_).string());
}

void EvaluateCommand::write_report_figures(const EvaluateReport& report) const {
    for (const std::string& figure : figures_) {
        if (!is_report_figure(figure)) continue;
        const std::vector<Plot> plots = report_figure(figure, report);
        if (plots.empty())
            spdlog::warn("--figure {}: not drawn, as nothing of it was measured on {}", figure,
                         counted(std::uint64_t(report.overall.frames), "scored frame"));
        write_plots(plots);
    }
}

void EvaluateCommand::make_simulated_figures(const EvaluateSettings& how) const {
    FigureSettings what;
    what.simulated = simulated();
    for (const std::string& figure : figures_)
        if (!is_report_figure(figure)) write_plots(simulated_figure(figure, what, how));
}

/// One of the outputs, so that the table would be in the middle of it.
bool EvaluateCommand::has_standard_output() const {
    return std::ranges::any_of(std::array{&json_, &csv_, &frame_csv_, &calibrated_},
                               [](const std::string* file) { return is_standard_output(*file); });
}

void EvaluateCommand::write(const EvaluateReport& report, const Signals& signals) const {
    if (!has_standard_output()) std::cout << printable(text_table(report), Lines::keep);
    write_result(json_, json(report) + "\n", overwrite_, signals);
    write_result(csv_, csv(report), overwrite_, signals);
    write_result(frame_csv_, frame_csv(report), overwrite_, signals);
}

void EvaluateCommand::calibrate(const EvaluateReport& report, const EvaluateSettings& how) const {
    SigmaCalibration found = eventide::calibrate(report, calibration_);
    found.sigma_rule = how.sigma_rule;
    write_calibrated(how.model, calibrated_, found, overwrite_);
    spdlog::info("{}: sigma times {:.4f}; PICP80 {:.3f} to {:.3f}, LL {:.3f} to {:.3f}",
                 calibrated_, found.factor, found.picp80_before, found.picp80_after,
                 found.ll_before, found.ll_after);
}

/// What the figures' names begin with in --plots; the rest depends on what is measured.
void EvaluateCommand::name_plots(NamedFiles& files) const {
    if (!figures_.empty()) files.expect_folder("--plots", plots_);
    const auto may_be_plot = [this](const std::filesystem::path& file) {
        const std::string kind = file.extension(), stem = file.stem();
        return (kind == ".svg" || kind == ".csv") &&
               std::ranges::any_of(figures_, [&](std::string figure) {
                   std::ranges::replace(figure, '-', '_');
                   return stem == figure || stem.starts_with(figure + "_");
               });
    };
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator{plots_, none})
        if (may_be_plot(entry.path())) files.writes("--plots", entry.path());
    for (const std::filesystem::path other : {json_, csv_, frame_csv_, calibrated_})
        if (may_be_plot(other) && resolved(other).parent_path() == resolved(plots_))
            files.writes("--plots", other);
}

void EvaluateCommand::name_evaluation_files(const EvaluateSettings& how, NamedFiles& files) const {
    files.may_replace(overwrite_);
    for (const std::string& input : inputs_)
        if (protocol_ == Protocol::recordings)
            name_recording("INPUT", input, files);
        else
            name_files("INPUT", input, files);
    files.reads("--model", how.model);
    files.reads("--lpips", lpips_);
    name_files("--images", images_, files);
    for (const auto& [option, file] : {std::pair{"--json", &json_},
                                       {"--csv", &csv_},
                                       {"--frame-csv", &frame_csv_},
                                       {"--calibrated", &calibrated_}})
        files.writes_when_done(option, *file);
    name_plots(files);
}

int EvaluateCommand::run(Program& program) {
    const EvaluateSettings settings = how(program);
    name_evaluation_files(settings, program.files);
    std::ranges::sort(figures_);
    figures_.erase(std::unique(figures_.begin(), figures_.end()),
                   figures_.end());  // named twice, made once
    require_figures_that_fit();
    require_outputs_that_fit();
    require_inputs();
    refuse_idle_flags(program.flags);
    FolderLock plots;
    if (!figures_.empty()) plots.take(plots_);
    make_simulated_figures(settings);
    if (!evaluates()) return exit_done;
    const EvaluateReport report = evaluate(settings);
    write(report, program.signals);
    if (protocol_ == Protocol::evreal && report.overall.frames == 0)
        throw Error(ErrorKind::input,
                    inputs_[0] + ": expected images in the parts that EVREAL scores, found none");
    write_report_figures(report);
    if (!calibrated_.empty()) calibrate(report, settings);
    return exit_done;
}

}  // namespace eventide::app
