// Figures that need images of other times and sizes than a plain evaluation makes.
#include "apps/evaluate/evaluation.h"
#include "apps/evaluate/figures.h"
#include "apps/evaluate/simulated_sequence.h"
#include "src/core/error.h"
#include "src/metrics/image_measures.h"

#include <opencv2/imgproc.hpp>

#include <cmath>
#include <map>
#include <set>

namespace eventide {
namespace {

/// Scores by line of the plot and x.
using Groups = std::map<std::pair<std::string, double>, std::vector<FrameScores>>;

/// Runs each sequence, possibly at once, and joins what they find in their order.
Groups over_sequences(const FigureSettings& what, const EvaluateSettings& how,
                      const std::function<void(int i, Groups& found)>& run) {
    const int n = what.simulated.sequences;
    std::vector<Groups> found(static_cast<std::size_t>(n));
    how.parallel_for(n, [&](int i) {
        run(i, found[std::size_t(i)]);
        if (how.progress) how.progress("sequence " + std::to_string(i + 1), 1);
    });
    Groups all;
    for (const Groups& one : found)
        for (const auto& [key, scores] : one)
            all[key].insert(all[key].end(), scores.begin(), scores.end());
    return all;
}

struct Labels {
    std::string name, title, x_label;
    bool log_x = false;
};

std::vector<Plot> plots_of(const Groups& groups, const Labels& labels,
                           const std::string& lpips_name) {
    using Score = std::optional<double> (*)(const SequenceScores&);
    struct Measure {
        std::string name, label;
        Score of;
    };
    const std::vector<Measure> measures{
        {"mse", "MSE", [](const SequenceScores& s) -> std::optional<double> { return s.raw.mse; }},
        {"ssim", "SSIM",
         [](const SequenceScores& s) -> std::optional<double> { return s.raw.ssim; }},
        {"lpips", lpips_name, [](const SequenceScores& s) { return s.raw.lpips; }},
        {"sigma", "mean sigma", [](const SequenceScores& s) { return s.mean_sigma; }}};
    std::vector<Plot> plots;
    for (const Measure& measure : measures) {
        Plot plot{.name = labels.name + "_" + measure.name,
                  .title = labels.title,
                  .x_label = labels.x_label,
                  .y_label = measure.label,
                  .log_x = labels.log_x};
        for (const auto& [key, frames] : groups) {
            const auto y = measure.of(mean_scores("", frames));
            if (!y) continue;
            if (plot.series.empty() || plot.series.back().label != key.first)
                plot.series.push_back({key.first, {}, {}, {}});
            plot.series.back().x.push_back(key.second);
            plot.series.back().y.push_back(*y);
        }
        if (!plot.series.empty()) plots.push_back(std::move(plot));
    }
    return plots;
}

ModelRun::Options options_of(const EvaluateSettings& how) {
    return {how.lookahead, how.sigma_rule, how.engine};
}

/// Cubic convolution with corners aligned, as the renderer's sizes are.
Array2<float> enlarged(const Array2<float>& image, int width, int height) {
    const cv::Mat from(image.height(), image.width(), CV_32F,
                       const_cast<float*>(image.values().data()));
    Array2<float> out(height, width);
    cv::Mat to(height, width, CV_32F, out.values().data());
    const double sx = double(image.width() - 1) / (width - 1);
    const double sy = double(image.height() - 1) / (height - 1);
    const cv::Mat back = (cv::Mat_<double>(2, 3) << sx, 0, 0, 0, sy, 0);
    cv::warpAffine(from, to, back, to.size(), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                   cv::BORDER_REPLICATE);
    return out;
}

}  // namespace

std::vector<Plot> spatial_super_resolution(const FigureSettings& what,
                                           const EvaluateSettings& how) {
    const Evaluation shared{"spatial", how};
    const auto textures = test_textures(what.simulated);
    const int width = what.simulated.width, height = what.simulated.height;
    const auto groups = over_sequences(what, how, [&](int i, Groups& found) {
        Judge judge{shared.lpips()};
        Array2<float> at_sensor_size;
        const auto use = [&](const Query& query, const Frame& frame) {
            const double scale = std::round(2. * query.width / width) / 2;
            if (query.width == width) at_sensor_size = frame.intensity;
            found[{"model", scale}].push_back(
                judge.judge(frame.intensity, frame.sigma, query.truth));
            found[{"cubic", scale}].push_back(
                judge.judge(enlarged(at_sensor_size, query.width, query.height), {}, query.truth));
        };
        ModelRun run{shared.model(), width, height, options_of(how), use};
        int k = 0;
        for_each_simulated_window(
            what.simulated, textures, i, shared.noise_filter(),
            [&](const EventWindow& event_window, const SimulatedStream& stream) {
                if (is_scored(what.simulated, k++)) {
                    run.ask(truth_query(stream, event_window.window.end, width, height));
                    for (const double scale : what.scales)
                        if (scale > 1)
                            run.ask(truth_query(stream, event_window.window.end,
                                                int(std::lround(scale * width)),
                                                int(std::lround(scale * height))));
                }
                run.push(event_window);
                return true;
            });
        run.finish();
    });
    return plots_of(groups, {"spatial", "spatial super-resolution", "size over the sensor's"},
                    shared.lpips() ? shared.lpips()->name() : "");
}

std::vector<Plot> temporal_super_resolution(const FigureSettings& what,
                                            const EvaluateSettings& how) {
    const Evaluation shared{"temporal", how};
    const auto textures = test_textures(what.simulated);
    const int width = what.simulated.width, height = what.simulated.height;
    const std::int64_t frame_us = what.simulated.frame_width.count();
    const auto offset_us = [&](int j, int n) { return (frame_us * j + n / 2) / n; };
    std::set<std::int64_t> offsets;  // of every image of every rate, within the event window
    for (int n = 1; n <= what.phases_max; ++n)
        for (int j = 1; j <= n; ++j) offsets.insert(offset_us(j, n));

    const auto groups = over_sequences(what, how, [&](int i, Groups& found) {
        Judge judge{shared.lpips()};
        struct Between {
            std::int64_t offset;
            Array2<float> intensity, truth;
            FrameScores scores;
        };
        std::vector<Between> pending;
        Array2<float> edge;
        // Once the frame's last image is there, blends of the two edges can be judged too.
        const auto use = [&](const Query& query, const Frame& frame) {
            if (query.truth.empty()) {  // the edge before a scored frame
                edge = frame.intensity;
                return;
            }
            const std::int64_t offset = (query.t - frame.window.begin).count();
            pending.push_back({offset, frame.intensity, query.truth,
                               judge.judge(frame.intensity, frame.sigma, query.truth)});
            if (offset != frame_us) return;
            std::map<std::int64_t, std::pair<FrameScores, FrameScores>> at;
            for (const Between& one : pending) {
                Array2<float> blend = edge;
                const float share = float(one.offset) / float(frame_us);
                for (std::size_t p = 0; p < blend.values().size(); ++p)
                    blend.values()[p] += share * (frame.intensity.values()[p] - blend.values()[p]);
                at[one.offset] = {one.scores, judge.judge(blend, {}, one.truth)};
            }
            for (int n = 1; n <= what.phases_max; ++n)
                for (int j = 1; j <= n; ++j) {
                    found[{"model", n}].push_back(at.at(offset_us(j, n)).first);
                    found[{"blend of edges", n}].push_back(at.at(offset_us(j, n)).second);
                }
            pending.clear();
        };
        ModelRun run{shared.model(), width, height, options_of(how), use};
        int k = 0;
        for_each_simulated_window(
            what.simulated, textures, i, shared.noise_filter(),
            [&](const EventWindow& event_window, const SimulatedStream& stream) {
                if (k > 0 && is_scored(what.simulated, k))
                    for (const std::int64_t offset : offsets)
                        run.ask(truth_query(stream,
                                            event_window.window.begin + SensorDuration{offset},
                                            width, height));
                if (is_scored(what.simulated, ++k)) {
                    Query last_edge;
                    last_edge.t = event_window.window.end;
                    run.ask(std::move(last_edge));
                }
                run.push(event_window);
                return true;
            });
        run.finish();
    });
    return plots_of(groups, {"temporal", "temporal super-resolution", "frames per event window"},
                    shared.lpips() ? shared.lpips()->name() : "");
}

namespace {

/// Of each sequence the change of intensity since the stop, by number of silent event windows.
using ChangeBySilence = std::map<int, double>;

Plot plot_of_change(const std::vector<ChangeBySilence>& moved,
                    const std::vector<int>& silent_windows) {
    Series change{"model", {}, {}, {}};
    for (const int silent : silent_windows) {
        double sum = 0;
        for (const ChangeBySilence& one : moved) sum += one.at(silent);
        change.x.push_back(silent);
        change.y.push_back(sum / double(moved.size()));
    }
    return {.name = "silence_change",
            .title = "a scene that stops",
            .x_label = "event windows without events",
            .y_label = "root mean square change of intensity",
            .series = {change},
            .log_x = true};
}

}  // namespace

std::vector<Plot> error_against_silence(const FigureSettings& what, const EvaluateSettings& how) {
    const Evaluation shared{"silence", how};
    const auto textures = test_textures(what.simulated);
    const int width = what.simulated.width, height = what.simulated.height;
    FigureSettings moving = what;
    moving.simulated.event_windows = what.moving_windows;
    std::ranges::sort(moving.silent_windows);
    std::vector<ChangeBySilence> moved(std::size_t(what.simulated.sequences));

    const auto groups = over_sequences(what, how, [&](int i, Groups& found) {
        Judge judge{shared.lpips()};
        SensorTime stop{};
        Array2<float> at_stop;
        const auto use = [&](const Query& query, const Frame& frame) {
            const auto silent = int((query.t - stop) / what.simulated.frame_width);
            if (at_stop.empty()) at_stop = clipped(frame.intensity);
            moved[std::size_t(i)][silent] =
                std::sqrt(mean_squared_error(clipped(frame.intensity), at_stop));
            found[{"model", silent}].push_back(
                judge.judge(frame.intensity, frame.sigma, query.truth));
        };
        ModelRun run{shared.model(), width, height, options_of(how), use};
        Query last;
        for_each_simulated_window(
            moving.simulated, textures, i, shared.noise_filter(),
            [&](const EventWindow& event_window, const SimulatedStream& stream) {
                stop = event_window.window.end;
                last = truth_query(stream, stop, width, height);
                run.push(event_window);
                return true;
            });
        for (const int silent : moving.silent_windows) {
            Query query = last;
            query.t = stop + silent * what.simulated.frame_width;
            run.ask(std::move(query));
        }
        // Nothing moves any more, and the sensor is without noise: empty event windows.
        const int most = moving.silent_windows.back();
        for (int s = 0; s < most + how.lookahead; ++s)
            run.push({.window = {stop + s * what.simulated.frame_width,
                                 stop + (s + 1) * what.simulated.frame_width},
                      .events = {}});
        run.finish();
    });
    std::vector<Plot> plots =
        plots_of(groups, {"silence", "a scene that stops", "event windows without events", true},
                 shared.lpips() ? shared.lpips()->name() : "");
    plots.push_back(plot_of_change(moved, moving.silent_windows));
    return plots;
}

}  // namespace eventide
