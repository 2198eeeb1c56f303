// Filling a report, sequence by sequence.
#include "src/evaluate/evaluation.h"

#include "src/core/error.h"

namespace eventide {

Evaluation::Evaluation(std::string subject, const EvaluateSettings& settings)
    : settings_(settings),
      model_(load_model(settings.model)),
      lpips_(load_lpips(settings.lpips)),
      judge_(lpips_.get()) {
    if (settings.lookahead < 0 || settings.lookahead > 2)
        throw Error(ErrorKind::usage,
                    "lookahead: expected 0, 1 or 2, found " + std::to_string(settings.lookahead));
    report_.subject = std::move(subject);
    report_.model = settings.model.filename().string();
    if (lpips_) report_.lpips_name = lpips_->name();
}

ModelRun Evaluation::make_run(int width, int height) {
    const ModelRun::Options options{settings_.lookahead, settings_.sigma_rule, settings_.engine};
    ModelRun run{model_, width, height, options,
                 [this](const Query& query, const Frame& frame) { judge(query, frame); }};
    engine_ = run.description();
    sensor_pixels_ = double(width) * height;
    return run;
}

void Evaluation::begin_sequence(const std::string& name, SensorTime t0, int expected_frames) {
    report_.sequences.emplace_back().scores.sequence = name;
    t0_ = t0;
    expected_frames_ = expected_frames;
    if (settings_.progress) settings_.progress(name, 0);
}

void Evaluation::judge(const Query& query, const Frame& frame) {
    SequenceReport& sequence = report_.sequences.back();
    FrameScores scores = judge_.judge(frame.intensity, frame.sigma, query.truth);
    scores.time_s = double((query.t - t0_).count()) * 1e-6;
    scores.events_per_pixel = double(frame.events) / sensor_pixels_;
    sequence.frames.push_back(scores);
    if (settings_.progress)
        settings_.progress(sequence.scores.sequence,
                           double(sequence.frames.size()) / std::max(1, expected_frames_));
}

void Evaluation::end_sequence(int not_rendered) {
    SequenceReport& sequence = report_.sequences.back();
    sequence.scores = mean_scores(sequence.scores.sequence, sequence.frames);
    sequence.not_rendered = not_rendered;
    if (not_rendered > 0)
        note(sequence.scores.sequence + ": " + std::to_string(not_rendered) +
             " references lie outside the event frames and were not compared");
}

EvaluateReport Evaluation::finish(const std::string& settings_text) {
    const SigmaRule rule = settings_.sigma_rule.value_or(model_.config.sigma_rule);
    report_.settings = "lookahead " + std::to_string(settings_.lookahead) + ", " + settings_text +
                       (rule == SigmaRule::mixture ? ", mixture sigma" : ", blended ln sigma") +
                       (engine_.empty() ? "" : ", " + engine_);
    report_.overall = overall_scores(report_.sequences);
    report_.observations = judge_.observations();
    return std::move(report_);
}

}  // namespace eventide
