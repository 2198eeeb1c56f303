// The part all evaluations share: the model, the perceptual network, and the report being filled.
#pragma once

#include "src/evaluate/evaluate.h"
#include "src/evaluate/model_run.h"

#include <memory>
#include <string>

namespace eventide {

class Evaluation {
public:
    /// Loads what the settings name. Throws Error.
    Evaluation(std::string subject, const EvaluateSettings& settings);

    /// A run of the model for one sensor size, whose pictures are judged into the open sequence.
    ModelRun make_run(int width, int height);

    void begin_sequence(const std::string& name, SensorTime t0, int expected_frames);
    /// `scored` says which queries count; others were asked for to no end.
    void judge(const Query& query, const Frame& frame);
    void end_sequence(int not_rendered);

    void note(const std::string& text) { report_.notes.push_back(text); }
    const Model& model() const { return model_; }
    const Lpips* lpips() const { return lpips_.get(); }

    /// The report, with the means over everything.
    EvaluateReport finish(const std::string& settings_text);

private:
    const EvaluateSettings& settings_;
    Model model_;
    std::unique_ptr<const Lpips> lpips_;
    Judge judge_;
    EvaluateReport report_;
    std::string engine_;
    SensorTime t0_{};
    int expected_frames_ = 0;
    double sensor_pixels_ = 1;
};

}  // namespace eventide
