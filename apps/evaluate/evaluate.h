// `eventide evaluate`: how good a model's images are, on recordings, simulation, or folders.
#pragma once

#include "apps/evaluate/report.h"
#include "replay/open_options.h"
#include "src/core/event.h"
#include "src/core/parallel_for.h"
#include "src/core/sensor_time.h"
#include "src/model/engine.h"
#include "src/model/model_config.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

/// What all evaluations of a model share.
struct EvaluateSettings {
    std::filesystem::path model;          ///< safetensors
    std::filesystem::path lpips;          ///< npz; empty: LPIPS is left out
    int lookahead = 0;                    ///< event windows after the image's own that may be used
    std::optional<SigmaRule> sigma_rule;  ///< else the model's own
    /// "model" (as the model was trained), "auto", "off" or a time; parse_noise_filter().
    std::string noise_filter = "model";
    /// For recordings, and as for a camera, which cannot wait: parse_lamp_flicker().
    std::string lamp_flicker = "auto";
    EngineOptions engine;
    bool fuse_images = false;  ///< images will be given to the model (evaluate_recordings sets it)
    /// Over sequences; results do not depend on it. Memory grows with those done at once.
    ParallelFor parallel_for = sequential_for;
    /// Called now and then: which sequence, and how much of it is done (0 to 1). From whatever
    /// threads parallel_for has, possibly at once.
    std::function<void(const std::string& sequence, double share)> progress;
    /// Told, in sentences for people, what had to be guessed of a recording, and where more of it
    /// was left out than taken. From the same threads. May be empty.
    std::function<void(const std::string&)> warn{};
};

/// Recordings with reference images, of any format open_recording() reads.
struct RecordingSettings {
    std::vector<std::filesystem::path> recordings;
    /// "reference": one event window between consecutive reference images, the first one empty
    /// (EVREAL); "model": as the model was trained; else as parse_window() has it ("50ms",
    /// "0.35epp"). Images are then rendered inside the event windows.
    std::string window = "reference";
    /// So many images are not scored, because the state is still empty, but at least one is.
    /// kSkipHalf: the first half.
    static constexpr int kSkipHalf = -1;
    int skip_images = 3;
    OpenOptions input;                   ///< what the recordings do not say themselves
    std::optional<ColourFilter> bayer;   ///< of their sensors; empty: what the recordings say
    std::optional<double> from_s, to_s;  ///< from the first event or image; what is scored
    /// Every so many images one is given to the model (ImageFusion) and not scored; 0: none.
    int given_images = 0;
};
EvaluateReport evaluate_recordings(const RecordingSettings& what, const EvaluateSettings& how);

/// The project's simulated test set: affine motion as the thesis' test set (docs/training.md,
/// "The thesis' scenes"), fixed seeds.
struct SimulatedSettings {
    std::filesystem::path images;  ///< folder of photographs; empty: procedural textures
    int last_images = 0;           ///< only the last so many by name; 0: all
    int sequences = 20;
    int event_windows = 150;        ///< per sequence
    int width = 240, height = 160;  ///< px, of the sensor
    SensorDuration frame_width{50'000};
    std::vector<double> phases{1};       ///< where in each event window images are compared, (0, 1]
    std::string preset = "thesis_test";  ///< src/simulate/presets.h
    double scale = 1;                    ///< images and truth are so many times larger
    int skip_frames = 4;                 ///< not scored: the state is still empty
    /// One in so many of the other frames is scored: neighbours are too alike to tell more.
    int score_every = 5;
    std::uint64_t seed = 4000;
};
EvaluateReport evaluate_simulated(const SimulatedSettings& what, const EvaluateSettings& how);

/// Images in one folder against those of the same rank (by name) in another; sizes must agree.
/// Sub-folders are sequences where both have them; `warn`, which may be empty, is told of those of
/// the references that the frames lack.
EvaluateReport evaluate_folders(const std::filesystem::path& frames,
                                const std::filesystem::path& references,
                                const std::filesystem::path& lpips,
                                const std::function<void(const std::string&)>& warn = {});

/// The EVREAL protocol (Ercan et al. 2023) on one sequence or a folder of them, in the
/// layouts of evreal_sequence.h: cuts by the sequence's name, state reset per sequence, inference
/// from 10 s before the cut.
EvaluateReport evaluate_evreal(const std::filesystem::path& dataset, const EvaluateSettings& how);

/// One factor for sigma, found on held-out data.
struct SigmaCalibration {
    double factor = 1;  ///< multiplies the model's present sigma_scale
    double picp80_before = 0, picp80_after = 0;
    double ll_before = 0, ll_after = 0;
    /// What it holds for, and what the model then blends by; else the model's own.
    std::optional<SigmaRule> sigma_rule{};
};
enum class CalibrationRule {
    coverage,    ///< PICP80 becomes .8 over all pixels
    likelihood,  ///< LL becomes largest
    cautious     ///< PICP80 becomes .8 in the sequence that needs it most, more in all others
};
SigmaCalibration calibrate(const EvaluateReport& held_out, CalibrationRule rule);

/// Writes `model` again as `to`, with sigma_scale multiplied, the calibration's rule and a line in
/// its card.
void write_calibrated(const std::filesystem::path& model, const std::filesystem::path& to,
                      const SigmaCalibration& calibration, bool overwrite = false);

}  // namespace eventide
