// The part all evaluations share: the model, the perceptual network, and the report being filled.
#pragma once

#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/model_run.h"
#include "pipeline/stages.h"
#include "src/binning/noise_filter.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace eventide {

struct SequenceResult {
    SequenceReport report;
    Observations observations;
    std::vector<std::string> notes;
};

class Evaluation {
public:
    /// Loads what the settings name. Throws Error.
    Evaluation(std::string subject, EvaluateSettings settings);

    /// Calls evaluate(i) for 0 <= i < n, possibly at the same time, and adds what they give to the
    /// report in their order.
    void run_sequences(int n, const std::function<SequenceResult(int)>& evaluate);

    void note(const std::string& text) { report_.notes.push_back(text); }
    const Model& model() const { return model_; }
    const Lpips* lpips() const { return lpips_.get(); }
    const EvaluateSettings& settings() const { return settings_; }
    /// None: all events are taken.
    std::optional<NoiseFilterSettings> noise_filter() const { return noise_filter_; }
    /// The filter that a live run has, for a recording of such a sensor; null: all events are
    /// taken.
    std::unique_ptr<EventFilter> filter_for(int width, int height) const;

    /// The report, with the means over everything.
    EvaluateReport finish(const std::string& settings_text);

private:
    EvaluateSettings settings_;
    Model model_;
    std::unique_ptr<const Lpips> lpips_;
    std::optional<NoiseFilterSettings> noise_filter_;
    EvaluateReport report_;
};

/// One sequence: a run of the model whose images are judged as they come.
class SequenceEvaluation {
public:
    struct About {
        std::string name;
        int width = 0, height = 0;  ///< px, of the sensor
        SensorTime t0{};            ///< times are told from here
        int expected_frames = 0;    ///< for progress
    };
    SequenceEvaluation(const Evaluation& evaluation, const About& about);

    ModelRun& run() { return run_; }

    /// Ends the run.
    SequenceResult finish();

private:
    void judge(const Query& query, const Frame& frame);

    const Evaluation& evaluation_;
    About about_;
    Judge judge_;
    SequenceResult result_;
    ModelRun run_;
};

}  // namespace eventide
