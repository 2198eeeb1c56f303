// Ours beside FireNet and E2VID in libtorch, in one run: an event window and a fresh frame of it on
// one thread and two, with AVX2 alone and with all the processor has, in milliseconds.
//   bench_peers [--sizes 240x180]... [--models default]... [--peers FireNet]... [--repetitions 30]
//               [--table FILE]
// FILE is what `eventide bench --report --peers FILE` shows beside its own.
// Instruction sets are a process' own, so each is measured by a child, one after the other.
#include "apps/bench/stage_table.h"
#include "pipeline/parallel_tbb.h"
#include "src/core/error.h"
#include "src/simulate/presets.h"
#include "tests/bench/peer_networks.h"

#include <CLI/CLI.hpp>

#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace eventide::bench {
namespace {

struct Options {
    std::vector<std::string> sizes{"240x180"}, models{"default", "small"},
        peers{"FireNet", "E2VID"};
    int repetitions = kLeastRepetitions;
    std::string table;

    bool asks_for(const char* peer) const { return std::ranges::find(peers, peer) != peers.end(); }
};

/// The quicker of both orders of memory.
Timing time_peer(PeerNetwork& network, torch::ScalarType type, int width, int height,
                 int repetitions) {
    const torch::InferenceMode no_gradients;
    Timing best;
    for (const auto format : {torch::MemoryFormat::Contiguous, torch::MemoryFormat::ChannelsLast}) {
        network.to(type, format);
        const torch::Tensor grid = torch::randn({1, 5, height, width}).to(type).contiguous(format);
        const Timing timing = timed(repetitions, [&](int) { network.step(grid); });
        if (best.wall_ms.median == 0 || timing.wall_ms.median < best.wall_ms.median) best = timing;
    }
    return best;
}

struct Line {
    std::string name, engine;
    int threads;
    double cpu_ms;
    Spread wall_ms;
};

/// How many times as quick as FireNet is `line`, in processor time and by the clock; FireNet as it
/// is quickest with as many threads.
void print_lines(const std::vector<Line>& lines) {
    std::printf("%-10s %-26s %3s %10s %26s %22s\n", "network", "engine", "thr", "cpu ms",
                "wall ms (quartiles)", "x FireNet, cpu / wall");
    for (const Line& line : lines) {
        double cpu = 0, wall = 0;
        for (const Line& other : lines) {
            if (other.name != "FireNet" || other.threads != line.threads) continue;
            cpu = cpu == 0 ? other.cpu_ms : std::min(cpu, other.cpu_ms);
            wall = wall == 0 ? other.wall_ms.median : std::min(wall, other.wall_ms.median);
        }
        const Spread& w = line.wall_ms;
        std::printf("%-10s %-26s %3d %10.2f %10.2f (%.2f-%.2f) %12.2f / %.2f\n", line.name.c_str(),
                    line.engine.c_str(), line.threads, line.cpu_ms, w.median, w.low, w.high,
                    cpu / line.cpu_ms, wall / w.median);
    }
}

/// Rows for the report; children append to what the parent began.
void write_lines(const std::vector<Line>& lines, const std::string& file, Instructions most,
                 int width, int height) {
    std::ofstream out{file, std::ios::app};
    for (const Line& line : lines)
        out << line.name << '\t' << line.engine << '\t'
            << (most == Instructions::avx2 ? "AVX2" : "all") << '\t' << width << '\t' << height
            << '\t' << line.threads << '\t' << line.cpu_ms << '\t' << line.wall_ms.median << '\n';
    if (!out) throw Error(ErrorKind::failed, file + ": cannot be written");
}

void measure(const Options& options, Instructions most, int width, int height) {
    const Peaks peaks = measure_peaks(most);
    std::printf("\n%dx%d, %s\n%s", width, height,
                most == Instructions::avx2 ? "AVX2 alone" : "all instructions",
                peaks_text(peaks).c_str());
    SimRecordingSettings scene;
    const SimulationPreset& preset = simulation_preset("demo");
    scene.scene = preset.scene;
    scene.sensor = preset.sensor;
    scene.seed = preset.seed;
    scene.width = width;
    scene.height = height;
    const std::vector<SceneWindow> windows = scene_windows(scene, 6);
    const bool has_bf16 = peaks.bf16 > 0;
    // E2VID wants sizes that can be halved three times.
    const int even_width = (width + 7) / 8 * 8, even_height = (height + 7) / 8 * 8;
    std::vector<StageRow> rows;
    std::vector<Line> lines;
    for (const int threads : {1, 2}) {
        torch::set_num_threads(threads);
        FireNet firenet;
        E2Vid e2vid;
        const auto peer = [&](const char* name, PeerNetwork& network, torch::ScalarType type, int w,
                              int h) {
            const Timing t = time_peer(network, type, w, h, options.repetitions);
            lines.push_back({name, type == torch::kFloat ? "libtorch, f32" : "libtorch, bf16",
                             threads, t.cpu_ms.median, t.wall_ms});
        };
        for (const auto type : {torch::kFloat, torch::kBFloat16}) {
            if (type == torch::kBFloat16 && !has_bf16) continue;
            if (options.asks_for("FireNet")) peer("FireNet", firenet, type, width, height);
            if (options.asks_for("E2VID")) peer("E2VID", e2vid, type, even_width, even_height);
        }
        for (const std::string& name : options.models)
            for (const Precision precision : {Precision::f32, Precision::bf16}) {
                if (precision == Precision::bf16 && !has_bf16) continue;
                StageSettings settings;
                settings.width = width;
                settings.height = height;
                settings.repetitions = options.repetitions;
                settings.engine.precision = precision;
                settings.engine.instructions = most;
                if (threads > 1) settings.engine.parallel_for = parallel_for_with(threads);
                const Model model =
                    load_model(EVENTIDE_SOURCE_DIR "/config/models/" + name + ".safetensors");
                StageRow row = measure_stages(name, model, windows, settings, peaks);
                row.threads = threads;
                const Spread &a = row.encode.time.wall_ms, &b = row.fresh.time.wall_ms;
                lines.push_back({name,
                                 row.engine,
                                 threads,
                                 row.encode.time.cpu_ms.median + row.fresh.time.cpu_ms.median,
                                 {a.median + b.median, a.low + b.low, a.high + b.high}});
                rows.push_back(row);
            }
    }
    print_lines(lines);
    if (!options.table.empty()) write_lines(lines, options.table, most, width, height);
    std::printf("%s", stages_text(rows).c_str());
}

/// Before libtorch or oneDNN ask what the processor has.
void limit_libraries(Instructions most) {
    if (most == Instructions::best) return;
    setenv("ATEN_CPU_CAPABILITY", "avx2", 1);
    setenv("ONEDNN_MAX_CPU_ISA", "AVX2", 1);
    setenv("DNNL_MAX_CPU_ISA", "AVX2", 1);
}

int run(const Options& options) {
    int failed = 0;
    if (!options.table.empty())
        std::ofstream{options.table}
            << "network\tengine\tinstructions\twidth\theight\tthreads\tcpu_ms\twall_ms\n";
    for (const Instructions most : {Instructions::avx2, Instructions::best}) {
        std::fflush(stdout);
        const pid_t child = fork();
        if (child == 0) {
            limit_libraries(most);
            try {
                for (const std::string& size : options.sizes) {
                    int width = 0, height = 0;
                    if (std::sscanf(size.c_str(), "%dx%d", &width, &height) != 2)
                        throw Error(ErrorKind::usage,
                                    "--sizes: expected WIDTHxHEIGHT, found " + size);
                    measure(options, most, width, height);
                }
            } catch (const std::exception& error) {
                std::fprintf(stderr, "bench_peers: %s\n", error.what());
                std::_Exit(1);
            }
            std::fflush(stdout);
            std::_Exit(0);
        }
        int status = 0;
        waitpid(child, &status, 0);
        failed |= status;
    }
    return failed != 0;
}

}  // namespace
}  // namespace eventide::bench

int main(int argc, char** argv) {
    eventide::bench::Options options;
    CLI::App app{"Ours beside FireNet and E2VID in libtorch, milliseconds per event window"};
    app.add_option("--sizes", options.sizes, "WIDTHxHEIGHT, any number of times");
    app.add_option("--models", options.models, "Shipped models, any number of times");
    app.add_option("--peers", options.peers, "Beside which networks, any number of times")
        ->check(CLI::IsMember({"FireNet", "E2VID"}));
    app.add_option("--repetitions", options.repetitions, "Of each measurement")
        ->check(CLI::Range(eventide::bench::kLeastRepetitions, 1'000'000));
    app.add_option("--table", options.table,
                   "Also as a table, columns apart by tabs, written anew");
    CLI11_PARSE(app, argc, argv);
    return eventide::bench::run(options);
}
