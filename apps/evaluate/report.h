// The outcome of an evaluation, and how it is written: a table for people, CSV and JSON for
// programs.
#pragma once

#include "apps/evaluate/scores.h"

#include <string>
#include <vector>

namespace eventide {

struct SequenceReport {
    SequenceScores scores;
    std::vector<FrameScores> frames;
    int not_rendered = 0;    ///< references before the first event window
    SigmaScale sigma_scale;  ///< what this sequence alone says about sigma
};

struct EvaluateReport {
    std::string subject;     ///< "recordings", "simulated", "folders", "evreal ECD"
    std::string model;       ///< file; empty for folders
    std::string lpips_name;  ///< "LPIPS-Squeeze", "LPIPS-Alex"; empty without
    std::string settings;    ///< lookahead, windows, skipped frames, engine: one line for people
    std::vector<SequenceReport> sequences;
    SequenceScores overall;  ///< over all frames of all sequences
    Observations observations;
    std::vector<std::string> notes;  ///< what was left out, and why
};

/// Means over all frames of all sequences, named as the only sequence, or "all".
SequenceScores overall_scores(const std::vector<SequenceReport>& sequences);

/// A table in plain text: one line per sequence, then all together.
std::string text_table(const EvaluateReport& report);

/// One line per sequence and one for all; `frame_csv` one per image.
std::string csv(const EvaluateReport& report);
std::string frame_csv(const EvaluateReport& report);

/// One object with the keys sequence, frames, raw: {mse, ssim, lpips}, affine: {mse, ssim, lpips},
/// picp80, ll, lpips_corr, correlation over everything, and the same keys per sequence in
/// "sequences". What was not measured is null. No line break at the end.
std::string json(const EvaluateReport& report);

}  // namespace eventide
