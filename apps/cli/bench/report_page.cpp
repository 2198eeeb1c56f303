// The report as a page, as JSON and as files.
#include "apps/bench/stage_table.h"
#include "apps/cli/bench/report.h"
#include "apps/cli/printable.h"
#include "src/io/output_file.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <map>

namespace eventide::app {

namespace {

using Cells = std::vector<std::string>;

std::string number(double value, const char* format = "%.3g") {
    if (!std::isfinite(value)) return "-";
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string optional_number(const std::optional<double>& value) {
    return value ? number(*value) : "-";
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : printable(text))
        out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : c == '>' ? "&gt;" : std::string(1, c);
    return out;
}

std::string without_line_end(std::string text) {
    while (text.ends_with('\n')) text.pop_back();
    return text;
}

std::string row_of(const Cells& cells, const char* tag) {
    std::string out = "<tr>";
    for (const std::string& cell : cells)
        out += std::string("<") + tag + ">" + escaped(cell) + "</" + tag + ">";
    return out + "</tr>\n";
}

std::string table(const Cells& head, const std::vector<Cells>& rows) {
    std::string out = "<table>\n" + row_of(head, "th");
    for (const Cells& cells : rows) out += row_of(cells, "td");
    return out + "</table>\n";
}

std::string section(const std::string& title, const std::string& explained,
                    const std::string& body) {
    return "<h2>" + escaped(title) + "</h2>\n<p>" + escaped(explained) + "</p>\n" + body;
}

std::string speed_table(const Report& report) {
    std::vector<Cells> rows;
    for (const SpeedRow& row : report.speed)
        rows.push_back({row.model, row.engine, show_size(row.sensor), row.window,
                        number(row.encode_ms), number(row.render_ms), number(row.total_ms()),
                        number(1000 / row.total_ms()), number(row.error.raw.mse, "%.4f"),
                        optional_number(row.error.raw.lpips),
                        row.against_double > 0 ? number(row.against_double, "%.1e") : "-",
                        row.is_on_front ? "yes" : ""});
    return table({"model", "engine", "sensor", "window", "encode, ms", "frame, ms", "both, ms",
                  "per second", "MSE", report.lpips_name.empty() ? "LPIPS" : report.lpips_name,
                  "codes to double, RMS of range", "front"},
                 rows);
}

std::string rate_table(const Report& report) {
    std::vector<Cells> rows;
    for (const RateRow& row : report.rates)
        rows.push_back({row.model, number(row.fps), number(row.render_ms),
                        number(row.times_real_time), number(row.fps * row.times_real_time)});
    return table({"model", "frames/s asked for", "frame, ms", "times real time", "frames/s made"},
                 rows);
}

std::string activity_table(const Report& report) {
    std::vector<Cells> rows;
    for (const bench::ActivityRow& row : report.activity)
        rows.push_back({number(100 * row.moving), number(100 * row.changed),
                        number(row.encode_ms.median), number(row.render_ms.median),
                        number(row.anywhere_ms.median), number(row.anywhere.most),
                        number(row.anywhere.rms)});
    return table({"moving, %", "tiles that change, %", "encode, ms", "frame, ms",
                  "frame, bounded, ms", "its largest error", "its RMS error"},
                 rows);
}

std::string load_table(const Report& report) {
    std::vector<Cells> rows;
    for (const LoadRow& row : report.loads)
        rows.push_back({number(row.events_per_s / 1e6), number(row.p50_ms), number(row.p99_ms),
                        number(row.behind, "%.2f")});
    return table({"million events/s", "latency p50, ms", "p99, ms", "time taken / time shown"},
                 rows);
}

std::string memory_table(const Report& report) {
    std::vector<Cells> rows;
    for (const MemoryRow& row : report.memory)
        rows.push_back({row.model, show_size(row.sensor),
                        row.resident_mib > 0 ? number(row.resident_mib, "%.0f") : "-"});
    return table({"model", "sensor", "resident at most, MiB"}, rows);
}

std::string peer_table(const Report& report) {
    std::vector<Cells> rows;
    for (const PeerRow& row : report.peers)
        rows.push_back({row.network, row.engine, row.instructions, show_size(row.sensor),
                        std::to_string(row.threads), number(row.cpu_ms)});
    return table({"network", "engine", "instructions", "sensor", "threads", "ms"}, rows);
}

std::string label_of(const SpeedRow& row) {
    return row.model + ", " + show_size(row.sensor);
}

/// One series of points for each model and size, and the front of each size as a line.
Plot speed_plot(const Report& report) {
    Plot plot{.name = "speed_error",
              .title = "Error against time per event window and frame",
              .x_label = "processor time, ms",
              .y_label = "MSE",
              .log_x = true};
    std::map<std::string, Series> points;
    std::map<std::string, std::map<double, double>> fronts;
    for (const SpeedRow& row : report.speed) {
        Series& series = points[label_of(row)];
        series.label = label_of(row);
        series.joined = false;
        series.x.push_back(row.total_ms());
        series.y.push_back(row.error.raw.mse);
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

nlohmann::ordered_json json_of(const SpeedRow& row) {
    nlohmann::ordered_json json{{"model", row.model},
                                {"engine", row.engine},
                                {"width", row.sensor.width},
                                {"height", row.sensor.height},
                                {"window", row.window},
                                {"encode_ms", row.encode_ms},
                                {"render_fresh_ms", row.render_ms},
                                {"mse", row.error.raw.mse},
                                {"front", row.is_on_front}};
    if (row.error.raw.lpips) json["lpips"] = *row.error.raw.lpips;
    if (row.error.raw.ssim > 0) json["ssim"] = row.error.raw.ssim;
    if (row.against_double > 0) json["codes_rms_of_range"] = row.against_double;
    return json;
}

}  // namespace

std::vector<Plot> plots_of(const Report& report) {
    return {speed_plot(report), rate_plot(report), activity_plot(report), load_plot(report)};
}

std::string page_of(const Report& report) {
    const std::vector<Plot> plots = plots_of(report);
    const std::string body =
        section("Speed against error",
                "Processor time of one thread, medians: encoding an event window in which "
                "everything moves, and a fresh frame of it; error of the frames against the "
                "simulated truth. The front: nothing of its size is both faster and nearer. Rows "
                "with other windows than 50 ms are of whole runs.",
                svg(plots[0]) + speed_table(report)) +
        (report.peers.empty()
             ? ""
             : section("Other networks",
                       "Their published shapes with random weights in libtorch, beside ours in one "
                       "run of bench_peers: processor time of an event window and a frame of it.",
                       peer_table(report))) +
        section("Frame rate",
                "The whole pipeline as fast as possible, all threads: 1 is real time.",
                svg(plots[1]) + rate_table(report)) +
        section("Activity",
                "A square in the middle of the scene moves, the rest is still. Bounded: frames at "
                "changing places of the window, copied where codes changed by at most .02.",
                svg(plots[2]) + activity_table(report)) +
        section("Latency",
                "Events at random places, 100 frames/s, at the camera's pace: from the last packet "
                "a frame saw to the frame written.",
                svg(plots[3]) + load_table(report)) +
        section("Memory", "Of a run of its own of one simulated second.", memory_table(report));
    return "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'><title>eventide: speed "
           "against error</title>\n<style>body{font:15px/1.45 sans-serif;max-width:60em;margin:2em "
           "auto;padding:0 1em}table{border-collapse:collapse;margin:1em 0}th,td{padding:.2em "
           ".7em;border-bottom:1px solid #ddd;text-align:right}th:first-child,td:first-child,"
           "th:nth-child(2),td:nth-child(2){text-align:left}</style></head><body>\n<h1>Speed "
           "against error</h1>\n<p>" +
           escaped(report.machine) + "<br>" + escaped(report.program) + "<br>" +
           escaped(report.settings) + "<br>" +
           escaped(without_line_end(bench::peaks_text(report.peaks))) + "</p>\n" + body +
           "</body></html>\n";
}

std::string json_of(const Report& report) {
    nlohmann::ordered_json json;
    json["machine"] = report.machine;
    json["program"] = report.program;
    json["settings"] = report.settings;
    for (const char* list : {"speed", "peers", "rates", "loads", "memory"})
        json[list] = nlohmann::ordered_json::array();
    for (const SpeedRow& row : report.speed) json["speed"].push_back(json_of(row));
    for (const RateRow& row : report.rates)
        json["rates"].push_back({{"model", row.model},
                                 {"fps", row.fps},
                                 {"render_ms", row.render_ms},
                                 {"times_real_time", row.times_real_time}});
    for (const PeerRow& row : report.peers)
        json["peers"].push_back({{"network", row.network},
                                 {"engine", row.engine},
                                 {"instructions", row.instructions},
                                 {"width", row.sensor.width},
                                 {"height", row.sensor.height},
                                 {"threads", row.threads},
                                 {"cpu_ms", row.cpu_ms}});
    json["activity"] = bench::activity_json(report.activity);
    for (const LoadRow& row : report.loads)
        json["loads"].push_back({{"events_per_s", row.events_per_s},
                                 {"latency_p50_ms", row.p50_ms},
                                 {"latency_p99_ms", row.p99_ms},
                                 {"time_taken", row.behind}});
    for (const MemoryRow& row : report.memory)
        json["memory"].push_back({{"model", row.model},
                                  {"width", row.sensor.width},
                                  {"height", row.sensor.height},
                                  {"resident_mib", row.resident_mib}});
    return json_text(json) + "\n";
}

std::vector<std::filesystem::path> report_files() {
    std::vector<std::filesystem::path> files{"index.html", "report.json"};
    for (const Plot& plot : plots_of({}))
        for (const char* extension : {".svg", ".csv"}) files.emplace_back(plot.name + extension);
    return files;
}

void write_report(const Report& report, const std::filesystem::path& folder, bool overwrite) {
    for (const Plot& plot : plots_of(report)) write_plot(plot, folder, overwrite);
    write_file(folder / "report.json", json_of(report), overwrite);
    write_file(folder / "index.html", page_of(report), overwrite);
}

}  // namespace eventide::app
