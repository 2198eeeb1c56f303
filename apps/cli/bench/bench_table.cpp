// Rows of speed and error -> text, JSON, plot.
#include "apps/cli/bench/bench_table.h"

#include "apps/bench/stage_table.h"
#include "apps/cli/printable.h"
#include "apps/cli/version.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

namespace eventide::app {

void print_bench_table(const std::vector<BenchRow>& rows, std::FILE* to) {
    std::fprintf(to, "%-12s %-28s %-10s %11s %9s %9s %7s %16s %8s\n", "model", "engine", "sensor",
                 "events/s", "ms/window", "ms/frame", "x real", "latency p50/p99", "MSE");
    for (const BenchRow& row : rows) {
        char mse[16] = "-";
        if (std::isfinite(row.mse)) std::snprintf(mse, sizeof mse, "%.4f", row.mse);
        std::fprintf(to, "%-12s %-28s %-10s %11.0f %9.2f %9.2f %7.2f %8.1f/%-7.1f %8s\n",
                     printable(row.model).c_str(), row.engine.c_str(),
                     show_size(row.sensor).c_str(), row.event_rate, row.encode_ms, row.render_ms,
                     row.times_real_time, row.latency_p50_ms, row.latency_p99_ms, mse);
    }
}

std::string bench_json(const std::vector<bench::StageRow>& stages,
                       const std::vector<bench::ActivityRow>& activity, const bench::Peaks& peaks,
                       const std::vector<BenchRow>& rows) {
    nlohmann::ordered_json json;
    json["machine"] = processor_text();
    json["program"] = "eventide " + version() + ", " + compiler_text();
    json["stages"] = bench::stages_json(stages, peaks);
    json["activity"] = bench::activity_json(activity);
    json["rows"] = nlohmann::ordered_json::array();
    for (const BenchRow& row : rows)
        json["rows"].push_back({{"model", row.model},
                                {"engine", row.engine},
                                {"width", row.sensor.width},
                                {"height", row.sensor.height},
                                {"events_per_s", row.event_rate},
                                {"encode_ms", row.encode_ms},
                                {"render_ms", row.render_ms},
                                {"times_real_time", row.times_real_time},
                                {"latency_p50_ms", row.latency_p50_ms},
                                {"latency_p99_ms", row.latency_p99_ms},
                                {"mse", row.mse}});
    return json_text(json) + "\n";
}

Plot bench_plot(const std::vector<BenchRow>& rows) {
    Plot plot{.name = "bench",
              .title = "Error against work per event window and frame",
              .x_label = "ms",
              .y_label = "MSE",
              .log_x = true};
    std::map<std::string, Series> by_size;
    for (const BenchRow& row : rows) {
        Series& series = by_size[show_size(row.sensor)];
        series.label = show_size(row.sensor);
        series.x.push_back(row.encode_ms + row.render_ms);
        series.y.push_back(row.mse);
    }
    for (auto& [size, series] : by_size) plot.series.push_back(std::move(series));
    return plot;
}

}  // namespace eventide::app
