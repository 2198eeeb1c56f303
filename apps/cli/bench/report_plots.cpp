// The report's drawings.
#include "apps/cli/bench/report.h"

#include <algorithm>
#include <map>
#include <string_view>

namespace eventide::app {

namespace {

std::string label_of(const SpeedRow& row) {
    return row.model + ", " + show_size(row.sensor);
}

/// What a point differs in from others of its series: arithmetic, and windows of other lengths. By
/// which instructions a processor does bf16 is the same for all.
std::string point_label(const SpeedRow& row) {
    constexpr std::string_view kEngine = "fast, ", kUsualWindow = "50ms";
    const std::size_t from = row.engine.starts_with(kEngine) ? kEngine.size() : 0;
    const std::string arithmetic = row.engine.substr(from, row.engine.find(" (") - from);
    return arithmetic + (row.window == kUsualWindow ? "" : ", " + row.window);
}

/// Of each network that is not ours and each size, the quickest way to run it on one thread.
std::vector<VerticalLine> peer_marks(const Report& report) {
    std::map<std::string, double> quickest;
    for (const PeerRow& row : report.peers) {
        if (row.threads != 1 || !row.engine.starts_with("libtorch")) continue;
        const std::string label = row.network + ", " + show_size(row.sensor);
        const auto [at, is_new] = quickest.try_emplace(label, row.wall_ms);
        if (!is_new) at->second = std::min(at->second, row.wall_ms);
    }
    std::vector<VerticalLine> marks;
    for (const auto& [label, ms] : quickest) marks.push_back({ms, label});
    return marks;
}

/// One series of points for each model and size, and the front of each size as a line.
Plot speed_plot(const Report& report) {
    Plot plot{.name = "speed_error",
              .title = "Error against time per event window and frame",
              .x_label = "processor time, ms",
              .y_label = "MSE",
              .marks = peer_marks(report),
              .log_x = true};
    std::map<std::string, Series> points;
    std::map<std::string, std::map<double, double>> fronts;
    for (const SpeedRow& row : report.speed) {
        Series& series = points[label_of(row)];
        series.label = label_of(row);
        series.joined = false;
        series.x.push_back(row.total_ms());
        series.y.push_back(row.error.raw.mse);
        series.labels.push_back(point_label(row));
        if (row.is_on_front) fronts[show_size(row.sensor)][row.total_ms()] = row.error.raw.mse;
    }
    for (auto& [label, series] : points) plot.series.push_back(std::move(series));
    for (const auto& [size, front] : fronts) {
        Series series{.label = "front, " + size, .x = {}, .y = {}, .spread = {}};
        for (const auto& [x, y] : front) {
            series.x.push_back(x);
            series.y.push_back(y);
        }
        plot.series.push_back(std::move(series));
    }
    return plot;
}

Plot rate_plot(const Report& report) {
    Plot plot{.name = "frame_rate",
              .title = "What more frames per second cost",
              .x_label = "frames/s of the video",
              .y_label = "times real time",
              .log_x = true};
    std::map<std::string, Series> by_model;
    for (const RateRow& row : report.rates) {
        Series& series = by_model[row.model];
        series.label = row.model;
        series.x.push_back(row.fps);
        series.y.push_back(row.times_real_time);
    }
    for (auto& [model, series] : by_model) plot.series.push_back(std::move(series));
    return plot;
}

Plot activity_plot(const Report& report) {
    Plot plot{.name = "activity",
              .title = "What moves is what costs",
              .x_label = "% of the sensor that moves",
              .y_label = "ms"};
    Series encode{.label = "encode"}, frame{.label = "frame"};
    for (const bench::ActivityRow& row : report.activity) {
        encode.x.push_back(100 * row.moving);
        encode.y.push_back(row.encode_ms.median);
        frame.x.push_back(100 * row.moving);
        frame.y.push_back(row.render_ms.median);
    }
    plot.series = {encode, frame};
    return plot;
}

Plot load_plot(const Report& report) {
    Plot plot{.name = "latency",
              .title = "Latency at the camera's pace, lookahead 0",
              .x_label = "million events/s",
              .y_label = "ms",
              .log_x = true};
    Series p50{.label = "p50"}, p99{.label = "p99"};
    for (const LoadRow& row : report.loads) {
        p50.x.push_back(row.events_per_s / 1e6);
        p50.y.push_back(row.p50_ms);
        p99.x.push_back(row.events_per_s / 1e6);
        p99.y.push_back(row.p99_ms);
    }
    plot.series = {p50, p99};
    return plot;
}

}  // namespace

std::vector<Plot> plots_of(const Report& report) {
    return {speed_plot(report), rate_plot(report), activity_plot(report), load_plot(report)};
}

}  // namespace eventide::app
