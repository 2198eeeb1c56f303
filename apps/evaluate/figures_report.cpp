// Figures that only need what every evaluation observes.
#include "apps/evaluate/figures.h"
#include "apps/evaluate/simulated_sequence.h"
#include "src/core/error.h"
#include "src/core/list_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace eventide {
namespace {

struct Measure {
    const char* name;
    const char* label;
    std::optional<double> (*of)(const FrameScores&);
};

const std::array<Measure, 3> kMeasures{
    {{"mse", "MSE", [](const FrameScores& f) -> std::optional<double> { return f.raw.mse; }},
     {"ssim", "SSIM", [](const FrameScores& f) -> std::optional<double> { return f.raw.ssim; }},
     {"lpips", "LPIPS", [](const FrameScores& f) { return f.raw.lpips; }}}};

/// Mean and deviation of y in groups of equally many points by x.
Series grouped(std::vector<std::pair<double, double>> points, const std::string& label) {
    constexpr std::size_t kGroups = 12;
    std::ranges::sort(points);
    Series out{label, {}, {}, {}};
    const std::size_t groups = std::min(kGroups, points.size());
    for (std::size_t g = 0; g < groups; ++g) {
        const std::size_t begin = g * points.size() / groups,
                          end = (g + 1) * points.size() / groups;
        double x = 0, y = 0, yy = 0;
        for (std::size_t i = begin; i < end; ++i) {
            x += points[i].first;
            y += points[i].second;
            yy += points[i].second * points[i].second;
        }
        const double n = double(end - begin);
        out.x.push_back(x / n);
        out.y.push_back(y / n);
        out.spread.push_back(std::sqrt(std::max(0., yy / n - y / n * (y / n))));
    }
    return out;
}

}  // namespace

std::vector<Plot> error_against_events(const EvaluateReport& report) {
    std::vector<Plot> plots;
    for (const Measure& measure : kMeasures) {
        std::vector<std::pair<double, double>> points;
        for (const SequenceReport& sequence : report.sequences)
            for (const FrameScores& frame : sequence.frames)
                if (const auto y = measure.of(frame))
                    points.emplace_back(frame.events_per_pixel, *y);
        if (points.empty()) continue;
        plots.push_back({.name = std::string("events_") + measure.name,
                         .title = std::string(measure.label) + " against events per pixel",
                         .x_label = "events per pixel in the event window",
                         .y_label = measure.label,
                         .series = {grouped(std::move(points), report.model)}});
    }
    return plots;
}

std::vector<Plot> error_against_sigma(const EvaluateReport& report) {
    Series pixels{"root mean square error of pixels", {}, {}, {}};
    Series patches{report.lpips_name + " of patches", {}, {}, {}};
    const Observations& seen = report.observations;
    for (std::size_t i = 0; i < seen.sigma_bins.size(); ++i) {
        const auto& bin = seen.sigma_bins[i];
        if (bin.pixels < 100) continue;  // fewer say nothing
        const double n = double(bin.pixels);
        pixels.x.push_back(bin.sigma / n);
        pixels.y.push_back(std::sqrt(bin.squared_error / n));
        if (const auto& patch = seen.patch_bins[i]; patch.patches > 0) {
            patches.x.push_back(patch.sigma / double(patch.patches));
            patches.y.push_back(patch.lpips / double(patch.patches));
        }
    }
    std::vector<Plot> plots{{.name = "sigma_error",
                             .title = "error against sigma",
                             .x_label = "sigma",
                             .y_label = "root mean square error",
                             .series = {pixels},
                             .diagonal = true}};
    if (!patches.x.empty())
        plots.push_back({.name = "sigma_lpips",
                         .title = report.lpips_name + " against sigma, 16x16 patches",
                         .x_label = "median sigma of the patch",
                         .y_label = report.lpips_name,
                         .series = {patches}});
    return plots;
}

Plot correlation_against_patch_size(const EvaluateReport& report) {
    Series series{report.model, {}, {}, {}};
    for (const Observations::PatchSize& at : report.observations.patch_sizes) {
        if (at.frames == 0) continue;
        const double mean = at.sum / at.frames;
        series.x.push_back(at.size);
        series.y.push_back(mean);
        series.spread.push_back(std::sqrt(std::max(0., at.squares / at.frames - mean * mean)));
    }
    return {.name = "patch_size",
            .title = "correlation of " + report.lpips_name + " and median sigma over patches",
            .x_label = "patch size, px",
            .y_label = "LPIPS_CORR",
            .series = {series}};
}

Plot reliability_diagram(const EvaluateReport& report) {
    Series inside{"inside the central interval", {}, {}, {}};
    Series below{"below the quantile", {}, {}, {}};
    const Reliability& seen = report.observations.reliability;
    for (int i = 0; i < Reliability::kLevels && seen.pixels() > 0; ++i) {
        inside.x.push_back(Reliability::level(i));
        inside.y.push_back(seen.inside(i));
        below.x.push_back(Reliability::level(i));
        below.y.push_back(seen.below(i));
    }
    return {.name = "reliability",
            .title = "reliability",
            .x_label = "promised share of pixels",
            .y_label = "found share of pixels",
            .series = {inside, below},
            .diagonal = true};
}

const std::vector<std::string>& figure_names() {
    static const std::vector<std::string> kNames{"events",  "sigma",    "patch-size", "reliability",
                                                 "spatial", "temporal", "silence"};
    return kNames;
}

void require_figure(std::string_view name) {
    if (std::ranges::count(figure_names(), name) > 0) return;
    throw Error(ErrorKind::usage, "no figure is called '" + std::string(name) +
                                      "'; there are: " + list_of(figure_names()));
}

std::vector<Plot> simulated_figure(std::string_view name, const FigureSettings& what,
                                   const EvaluateSettings& how) {
    if (name != "silence") check_simulated(what.simulated);  // that has event windows of its own
    if (name == "spatial") return spatial_super_resolution(what, how);
    if (name == "temporal") return temporal_super_resolution(what, how);
    return error_against_silence(what, how);
}

bool is_report_figure(std::string_view name) {
    return name == "events" || name == "sigma" || name == "patch-size" || name == "reliability";
}

std::vector<Plot> report_figure(std::string_view name, const EvaluateReport& report) {
    std::vector<Plot> plots{reliability_diagram(report)};
    if (name == "events") plots = error_against_events(report);
    if (name == "sigma") plots = error_against_sigma(report);
    if (name == "patch-size") plots = {correlation_against_patch_size(report)};
    std::erase_if(plots, [](const Plot& plot) {
        return std::ranges::all_of(plot.series, [](const Series& s) { return s.x.empty(); });
    });
    return plots;
}

}  // namespace eventide
