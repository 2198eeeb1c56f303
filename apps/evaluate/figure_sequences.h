// What the figures share that need simulated runs of their own.
#pragma once

#include "apps/evaluate/evaluation.h"
#include "apps/evaluate/figures.h"
#include "apps/evaluate/simulated_sequence.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace eventide {

/// Scores by line of the plot and x.
using FigureScores = std::map<std::pair<std::string, double>, std::vector<FrameScores>>;

struct FigureLabels {
    std::string name, title, x_label;
    bool log_x = false;
};

/// The sequences that a figure goes through, and the model that sees them.
class FigureSequences {
public:
    /// Loads what the settings name; borrows them. Throws Error.
    FigureSequences(const std::string& subject, const FigureSettings& what,
                    const EvaluateSettings& how);

    int width() const { return what_.simulated.width; }  ///< px, of the sensor
    int height() const { return what_.simulated.height; }
    Judge make_judge() const { return Judge{evaluation_.lpips()}; }
    ModelRun make_run(ModelRun::Use use) const;

    /// Calls run(i, what it finds) for each sequence, possibly at once, and joins what they find in
    /// their order.
    FigureScores run_each(const std::function<void(int i, FigureScores& found)>& run) const;

    /// Each event window of sequence `i`: `ask` may ask for images within it before `run` takes it.
    void push_windows(
        int i, ModelRun& run,
        const std::function<void(const EventWindow&, const SimulatedStream&)>& ask) const;

    /// One for each measure that was taken.
    std::vector<Plot> plots_of(const FigureScores& scores, const FigureLabels& labels) const;

private:
    const FigureSettings& what_;
    const EvaluateSettings& how_;
    Evaluation evaluation_;
    std::shared_ptr<const TextureLibrary> textures_;
};

}  // namespace eventide
