#include "apps/evaluate/figure_sequences.h"

namespace eventide {
namespace {

using Score = std::optional<double> (*)(const SequenceScores&);

struct Measure {
    std::string name, label;
    Score of;
};

std::vector<Measure> measures_with(const std::string& lpips_name) {
    return {
        {"mse", "MSE", [](const SequenceScores& s) -> std::optional<double> { return s.raw.mse; }},
        {"ssim", "SSIM",
         [](const SequenceScores& s) -> std::optional<double> { return s.raw.ssim; }},
        {"lpips", lpips_name, [](const SequenceScores& s) { return s.raw.lpips; }},
        {"sigma", "mean sigma", [](const SequenceScores& s) { return s.mean_sigma; }}};
}

}  // namespace

FigureSequences::FigureSequences(const std::string& subject, const FigureSettings& what,
                                 const EvaluateSettings& how)
    : what_{what}, how_{how}, evaluation_{subject, how}, textures_{test_textures(what.simulated)} {}

ModelRun FigureSequences::make_run(ModelRun::Use use) const {
    const ModelRun::Options options{how_.lookahead, how_.sigma_rule, how_.engine};
    return {evaluation_.model(), width(), height(), options, std::move(use)};
}

FigureScores FigureSequences::run_each(
    const std::function<void(int i, FigureScores& found)>& run) const {
    const int n = what_.simulated.sequences;
    std::vector<FigureScores> found(static_cast<std::size_t>(n));
    how_.parallel_for(n, [&](int i) {
        run(i, found[std::size_t(i)]);
        if (how_.progress) how_.progress("sequence " + std::to_string(i + 1), 1);
    });
    FigureScores all;
    for (const FigureScores& one : found)
        for (const auto& [key, scores] : one)
            all[key].insert(all[key].end(), scores.begin(), scores.end());
    return all;
}

void FigureSequences::push_windows(
    int i, ModelRun& run,
    const std::function<void(const EventWindow&, const SimulatedStream&)>& ask) const {
    for_each_simulated_window(what_.simulated, textures_, i, evaluation_.noise_filter(),
                              [&](const EventWindow& event_window, const SimulatedStream& stream) {
                                  ask(event_window, stream);
                                  run.push(event_window);
                                  return true;
                              });
}

std::vector<Plot> FigureSequences::plots_of(const FigureScores& scores,
                                            const FigureLabels& labels) const {
    const Lpips* lpips = evaluation_.lpips();
    std::vector<Plot> plots;
    for (const Measure& measure : measures_with(lpips ? lpips->name() : "")) {
        Plot plot{.name = labels.name + "_" + measure.name,
                  .title = labels.title,
                  .x_label = labels.x_label,
                  .y_label = measure.label,
                  .log_x = labels.log_x};
        for (const auto& [key, frames] : scores) {
            const auto y = measure.of(mean_scores("", frames));
            if (!y) continue;
            if (plot.series.empty() || plot.series.back().label != key.first)
                plot.series.push_back({key.first, {}, {}, {}});
            plot.series.back().x.push_back(key.second);
            plot.series.back().y.push_back(*y);
        }
        if (!plot.series.empty()) plots.push_back(std::move(plot));
    }
    return plots;
}

}  // namespace eventide
