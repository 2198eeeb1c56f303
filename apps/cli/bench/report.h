// Speed against error: what `eventide bench --report` measures, and the page it becomes.
#pragma once

#include "apps/bench/activity.h"
#include "apps/bench/peaks.h"
#include "apps/cli/bench/bench_settings.h"
#include "apps/cli/command.h"
#include "apps/evaluate/plot.h"

#include <filesystem>
#include <string>
#include <vector>

namespace eventide::app {

/// Another network, measured by tests/bench/bench_peers on the same machine.
struct PeerRow {
    std::string network, engine, instructions;
    Size sensor;
    int threads = 1;
    /// An event window and a frame of it, by the clock: libtorch's threads spin while they wait.
    double wall_ms = 0;
};

/// One way to run a network: what it takes for an event window and a frame of it, on one thread,
/// and how far the frames are from the truth.
struct SpeedRow {
    std::string model, engine, window;
    Size sensor;
    double encode_ms = 0, render_ms = 0;  ///< processor time, medians
    double against_double = 0;  ///< root mean square of codes, of their range; 0: not measured
    SequenceScores error;
    bool is_on_front = false;  ///< none of its size is both faster and nearer to the truth

    double total_ms() const { return encode_ms + render_ms; }
};

/// Frames per second of the video against what a second of the sensor takes.
struct RateRow {
    std::string model;
    double fps = 0, times_real_time = 0, render_ms = 0;
};

/// Latency of a recording at the camera's pace, by how much it says.
struct LoadRow {
    double events_per_s = 0, p50_ms = 0, p99_ms = 0;
    double behind = 0;  ///< seconds taken over seconds of the recording
};

/// A file of bench_peers --table; an empty path gives none. Throws Error (input) naming the line.
std::vector<PeerRow> read_peers(const std::filesystem::path& file);

struct MemoryRow {
    std::string model;
    Size sensor;
    double resident_mib = 0;  ///< at most, of a run of its own
};

struct Report {
    std::string machine, program, settings, lpips_name;
    bench::Peaks peaks;
    std::vector<SpeedRow> speed;
    std::vector<RateRow> rates;
    std::vector<bench::ActivityRow> activity;
    std::vector<LoadRow> loads;
    std::vector<MemoryRow> memory;
    std::vector<PeerRow> peers;
};

/// The ways to run a network that are compared: each kind of arithmetic that was asked for and that
/// this processor has a reason to choose, by the instructions that may be used.
std::vector<EngineOptions> engines_of(const BenchSettings& settings, const bench::Peaks& peaks);

/// A few minutes. Ends early, with what there is, when a signal comes.
Report measure_report(const BenchSettings& settings, const std::vector<PeerRow>& peers,
                      Program& program);

/// Marks, of each sensor size, the rows that no other beats in both time and MSE; of rows with the
/// same error within half a per cent, the fastest.
void mark_front(std::vector<SpeedRow>& rows);

/// The report's plots, in the order of the page.
std::vector<Plot> plots_of(const Report& report);

/// One page without anything from elsewhere: tables, and the plots in it.
std::string page_of(const Report& report);
std::string json_of(const Report& report);

/// The names of the files that write_report() makes.
std::vector<std::filesystem::path> report_files();

/// index.html, report.json, and each plot as SVG and CSV. Throws Error.
void write_report(const Report& report, const std::filesystem::path& folder, bool overwrite);

}  // namespace eventide::app
