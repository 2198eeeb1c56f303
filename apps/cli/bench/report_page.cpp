// The report as a page, and as files.
#include "apps/bench/stage_table.h"
#include "apps/cli/bench/report.h"
#include "apps/cli/printable.h"
#include "src/io/output_file.h"

#include <cmath>
#include <cstdio>

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
                        std::to_string(row.threads), number(row.wall_ms)});
    return table({"network", "engine", "instructions", "sensor", "threads", "ms"}, rows);
}

}  // namespace

std::string page_of(const Report& report) {
    const std::vector<Plot> plots = plots_of(report);
    const std::string body =
        section("Speed against error",
                "Processor time of one thread, medians: encoding an event window in which "
                "everything moves, and a fresh frame of it; error of the frames against the "
                "simulated truth. The front: nothing of its size is both faster and nearer. Rows "
                "with other windows than 50 ms are of whole runs. Dashed: other networks, whose "
                "error was not measured.",
                svg(plots[0]) + speed_table(report)) +
        (report.peers.empty()
             ? ""
             : section("Other networks",
                       "Their published shapes with random weights in libtorch, beside ours in one "
                       "run of bench_peers: an event window and a frame of it, by the clock.",
                       peer_table(report))) +
        section("Frame rate", "The whole pipeline as fast as possible: 1 is real time.",
                svg(plots[1]) + rate_table(report)) +
        section("Activity",
                "A square in the middle of the scene moves, the rest is still. Bounded: frames at "
                "changing places of the window, copied where codes changed by no more than "
                "--still-codes.",
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
