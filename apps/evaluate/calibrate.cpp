// One factor that makes sigma true on held-out data.
#include "apps/evaluate/evaluate.h"
#include "src/core/error.h"
#include "src/model/model_file.h"

#include <algorithm>
#include <cstdio>

namespace eventide {
namespace {

double factor_by(CalibrationRule rule, const EvaluateReport& held_out) {
    const SigmaScale& all = held_out.observations.sigma_scale;
    if (rule == CalibrationRule::likelihood) return all.by_likelihood();
    if (rule == CalibrationRule::coverage) return all.by_coverage();
    double largest = 0;
    for (const SequenceReport& sequence : held_out.sequences)
        if (sequence.sigma_scale.pixels() > 0)
            largest = std::max(largest, sequence.sigma_scale.by_coverage());
    return largest;
}

}  // namespace

SigmaCalibration calibrate(const EvaluateReport& held_out, CalibrationRule rule) {
    const SigmaScale& errors = held_out.observations.sigma_scale;
    if (errors.pixels() == 0)
        throw Error(ErrorKind::usage,
                    "calibration: expected an evaluation with sigma, found no pixel with one");
    const double factor = factor_by(rule, held_out);
    return {.factor = factor,
            .picp80_before = errors.coverage_80_after(1),
            .picp80_after = errors.coverage_80_after(factor),
            .ll_before = errors.log_likelihood_after(1),
            .ll_after = errors.log_likelihood_after(factor)};
}

void write_calibrated(const std::filesystem::path& from, const std::filesystem::path& to,
                      const SigmaCalibration& calibration, bool overwrite) {
    Model model = load_model(from);
    model.config.sigma_scale = float(double(model.config.sigma_scale) * calibration.factor);
    model.config.sigma_rule = calibration.sigma_rule.value_or(model.config.sigma_rule);
    char line[160];
    std::snprintf(line, sizeof line,
                  "sigma calibrated by %.4f: PICP80 %.3f -> %.3f, LL %.2f -> %.2f on held-out data",
                  calibration.factor, calibration.picp80_before, calibration.picp80_after,
                  calibration.ll_before, calibration.ll_after);
    if (!model.config.card.empty()) model.config.card += "\n";
    model.config.card += line;
    save_model(to, model, overwrite);
}

}  // namespace eventide
