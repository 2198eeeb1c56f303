// The figures that tell how a model behaves (after the thesis' chapter 4), as plots.
#pragma once

#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/plot.h"

#include <string_view>
#include <vector>

namespace eventide {

/// From any evaluation of a model:
/// error against events per pixel of the event window, one plot per measure;
std::vector<Plot> error_against_events(const EvaluateReport& report);
/// the real error of pixels (and LPIPS of patches) that were given some sigma;
std::vector<Plot> error_against_sigma(const EvaluateReport& report);
/// LPIPS_CORR against the size of the patches it is taken over, mean and deviation over frames;
Plot correlation_against_patch_size(const EvaluateReport& report);
/// how often the truth lies inside the interval that should hold it so often.
Plot reliability_diagram(const EvaluateReport& report);

/// From simulated runs of their own, one plot per measure.
struct FigureSettings {
    SimulatedSettings simulated;
    std::vector<double> scales{1, 1.5, 2, 3, 4, 5, 6};
    int phases_max = 6;       ///< images per event window
    int moving_windows = 40;  ///< event windows before the silence
    std::vector<int> silent_windows{0, 1, 2, 4, 6, 10, 20, 38, 60, 100, 200, 600, 2000, 6000};
};
/// Images rendered at a multiple of the sensor's size, against those of its size enlarged by
/// cubic convolution.
std::vector<Plot> spatial_super_resolution(const FigureSettings& what, const EvaluateSettings& how);
/// Images between the edges of event windows, against blends of those at the edges.
std::vector<Plot> temporal_super_resolution(const FigureSettings& what,
                                            const EvaluateSettings& how);
/// A scene that stops: error, mean sigma, and the change of intensity since the stop.
std::vector<Plot> error_against_silence(const FigureSettings& what, const EvaluateSettings& how);

/// Names of figures, for the command line: "events", "sigma", "patch-size", "reliability",
/// "spatial", "temporal", "silence".
const std::vector<std::string>& figure_names();

/// Throws Error(usage) for another name, with those there are.
void require_figure(std::string_view name);

/// Whether a figure only needs what any evaluation observes, and such a figure: those of its plots
/// that have points.
bool is_report_figure(std::string_view name);
std::vector<Plot> report_figure(std::string_view name, const EvaluateReport& report);

/// One of the others. Throws Error (usage) for sequences of which nothing would be scored.
std::vector<Plot> simulated_figure(std::string_view name, const FigureSettings& what,
                                   const EvaluateSettings& how);

}  // namespace eventide
