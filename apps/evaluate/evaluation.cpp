// Filling a report, sequence by sequence.
#include "apps/evaluate/evaluation.h"

#include "pipeline/filters/event_filter.h"
#include "src/binning/flicker_pairs.h"
#include "src/core/error.h"
#include "src/model/model_trial.h"

namespace eventide {

Evaluation::Evaluation(std::string subject, EvaluateSettings settings)
    : settings_(std::move(settings)),
      model_(load_model(settings_.model)),
      lpips_(load_lpips(settings_.lpips)),
      noise_filter_(parse_noise_filter(settings_.noise_filter, model_.config.noise_filter)) {
    if (settings_.lookahead < 0 || settings_.lookahead > 2)
        throw Error(ErrorKind::usage,
                    "lookahead: expected 0, 1 or 2, found " + std::to_string(settings_.lookahead));
    parse_lamp_flicker(settings_.lamp_flicker, false);  // of every protocol
    try_model(model_, settings_.model.string());
    report_.subject = std::move(subject);
    report_.model = settings_.model.filename().string();
    if (lpips_) report_.lpips_name = lpips_->name();
}

std::unique_ptr<EventFilter> Evaluation::filter_for(int width, int height) const {
    return event_filter({.hot_pixels = "off",
                         .noise_filter = settings_.noise_filter,
                         .lamp_flicker = settings_.lamp_flicker},
                        model_.config, width, height);
}

void Evaluation::run_sequences(int n, const std::function<SequenceResult(int)>& evaluate) {
    std::vector<SequenceResult> results(static_cast<std::size_t>(n));
    settings_.parallel_for(n, [&](int i) { results[std::size_t(i)] = evaluate(i); });
    for (SequenceResult& result : results) {
        report_.sequences.push_back(std::move(result.report));
        report_.observations += result.observations;
        report_.notes.insert(report_.notes.end(), result.notes.begin(), result.notes.end());
    }
}

EvaluateReport Evaluation::finish(const std::string& settings_text) {
    const SigmaRule rule = settings_.sigma_rule.value_or(model_.config.sigma_rule);
    report_.settings =
        "lookahead " + std::to_string(settings_.lookahead) + ", " + settings_text +
        (settings_.engine.self_ensemble > 1
             ? ", self-ensemble of " + std::to_string(settings_.engine.self_ensemble)
             : "") +
        (noise_filter_ ? ", noise filter " + noise_filter_text(*noise_filter_) : "") +
        (rule == SigmaRule::mixture ? ", mixture sigma" : ", blended ln sigma");
    report_.overall = overall_scores(report_.sequences);
    return std::move(report_);
}

SequenceEvaluation::SequenceEvaluation(const Evaluation& evaluation, const About& about)
    : evaluation_(evaluation),
      about_(about),
      judge_(evaluation.lpips()),
      run_(evaluation.model(), about.width, about.height,
           {evaluation.settings().lookahead, evaluation.settings().sigma_rule,
            evaluation.settings().engine, evaluation.settings().fuse_images},
           [this](const Query& query, const Frame& frame) { judge(query, frame); }) {}

void SequenceEvaluation::judge(const Query& query, const Frame& frame) {
    FrameScores scores = judged(about_.name, judge_, frame.intensity, frame.sigma, query.truth);
    scores.time_s = double((query.t - about_.t0).count()) * 1e-6;
    scores.events_per_pixel = double(frame.events) / (double(about_.width) * about_.height);
    result_.report.frames.push_back(scores);
    if (const auto& progress = evaluation_.settings().progress)
        progress(about_.name,
                 double(result_.report.frames.size()) / std::max(1, about_.expected_frames));
}

SequenceResult SequenceEvaluation::finish() {
    run_.finish();
    result_.report.scores = mean_scores(about_.name, result_.report.frames);
    result_.report.not_rendered = run_.not_rendered();
    if (run_.not_rendered() > 0)
        result_.notes.push_back(about_.name + ": " + std::to_string(run_.not_rendered()) +
                                " references lie outside the event windows and were not compared");
    result_.observations = judge_.observations();
    result_.report.sigma_scale = result_.observations.sigma_scale;
    return std::move(result_);
}

}  // namespace eventide
