// What the report measures, one thing after the other on an otherwise idle program.
#include "apps/bench/stage_table.h"
#include "apps/bench/stages.h"
#include "apps/cli/bench/report.h"
#include "apps/cli/progress.h"
#include "apps/cli/settings/model_path.h"
#include "apps/cli/settings/words.h"
#include "apps/cli/stress/double_network.h"
#include "apps/cli/version.h"
#include "src/binning/binner.h"
#include "src/model/latent_codes.h"

#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace eventide::app {

namespace {

constexpr int kWindows = 6;                     ///< of a scene, for the stages alone
constexpr int kCompared = 3;                    ///< of them, against double precision
constexpr double kMaxComparedPixels = 100'000;  ///< double precision takes seconds a window beyond

/// Latent maps of the first windows, by this engine and in double precision.
double codes_against_double(const Model& model, const std::vector<bench::SceneWindow>& windows,
                            const bench::StageSettings& settings) {
    if (double(settings.width) * settings.height > kMaxComparedPixels) return 0;
    Encoder encoder{model, settings.width, settings.height, settings.engine};
    const auto exact = stress::make_double(model, settings.height, settings.width);
    Binner binner{model.config.bins, settings.height, settings.width};
    VoxelGrid grid = binner.make_output();
    LatentMap map = encoder.make_output();
    stress::Distance distance;
    for (int i = 0; i < kCompared && i < int(windows.size()); ++i) {
        binner.process(windows[std::size_t(i)].event_window(), grid);
        encoder.encode(grid, map);
        distance.add(codes_in_float(map, model.config.latent).values(),
                     exact->step(stress::in_double(grid.values)).values());
    }
    return distance.rms_of_range();
}

class Measurement {
public:
    Measurement(const BenchSettings& settings, Program& program)
        : settings_{settings}, program_{program}, progress_{program.quiet} {}

    void speed(Report& report) {
        for (const std::string& size : settings_.sizes) {
            const auto windows =
                bench::scene_windows(recording_of(settings_.scene, parse_size(size)), kWindows);
            const auto data =
                simulated_packets(settings_.scene, parse_size(size), settings_.seconds);
            for (const std::string& model : settings_.models)
                for (const EngineOptions& engine : engines_of(settings_, report.peaks)) {
                    if (stopping(model + ", " + size)) return;
                    report.speed.push_back(speed_row(model, engine, windows, data, report));
                }
        }
        shorter_windows(report);
        mark_front(report.speed);
    }

    void rates(Report& report) {
        const auto data =
            simulated_packets(settings_.scene, parse_size(settings_.sizes[0]), settings_.seconds);
        for (const std::string& model : settings_.models)
            for (const int fps : {20, 50, 100, 200, 500, 1000}) {
                if (stopping(model + ", " + std::to_string(fps) + " frames/s")) return;
                PipelineBenchSettings how = pipeline_settings(model);
                how.rate = {fps, 1};
                const PipelineBench run = measure_pipeline(data, how, program_.signals);
                report.rates.push_back({run.model, double(fps), settings_.seconds / run.seconds,
                                        milliseconds(run.counters.render.p50)});
            }
    }

    void activity(Report& report) {
        const Size size = parse_size(settings_.sizes.back());
        const auto windows = bench::scene_windows(recording_of(settings_.scene, size), kWindows);
        if (stopping("activity")) return;
        const auto file = find_model(settings_.models[0]);
        report.activity =
            bench::measure_activity(file.stem().string(), load_model(file), windows,
                                    settings_.stage(size, precision()), {0, .01, .05, .25, 1});
    }

    void loads(Report& report) {
        for (const double rate : {.1e6, .5e6, 1e6, 2e6, 5e6, 10e6, 20e6}) {
            if (stopping("latency at " + std::to_string(int(rate / 1e3)) + " k events/s")) return;
            const double seconds = std::min(1.0, settings_.seconds);
            const auto data = random_packets(parse_size(settings_.sizes[0]), rate, seconds);
            PipelineBenchSettings how = pipeline_settings(settings_.models[0]);
            how.window = "50ms";
            how.rate = {100, 1};
            how.speed = 1;
            const PipelineBench run = measure_pipeline(data, how, program_.signals);
            report.loads.push_back({rate, milliseconds(run.counters.latency.p50),
                                    milliseconds(run.counters.latency.p99), run.seconds / seconds});
        }
    }

    void memory(Report& report) {
        for (const std::string& size : settings_.sizes)
            for (const std::string& model : settings_.models) {
                if (stopping("memory of " + model + ", " + size)) return;
                report.memory.push_back({find_model(model).stem().string(), parse_size(size),
                                         resident_mib(model, size)});
            }
    }

private:
    bool stopping(const std::string& what) {
        progress_.show(0, what);
        return program_.signals.stopping();
    }

    /// Where one has to do for all.
    Precision precision() const { return parse_word(settings_.precisions[0], kPrecisionWords); }

    PipelineBenchSettings pipeline_settings(const std::string& model) const {
        return settings_.pipeline(model, precision());
    }

    SpeedRow speed_row(const std::string& name, const EngineOptions& engine,
                       const std::vector<bench::SceneWindow>& windows,
                       const std::shared_ptr<const RecordedPackets>& data, const Report& report) {
        const Size sensor{data->info.width, data->info.height};
        const std::filesystem::path file = find_model(name);
        const Model model = load_model(file);
        bench::StageSettings how = settings_.stage(sensor, engine.precision);
        how.engine = engine;
        const auto stages =
            bench::measure_stages(file.stem().string(), model, windows, how, report.peaks);
        PipelineBenchSettings of_error = pipeline_settings(name);
        of_error.engine = engine.engine;
        of_error.precision = engine.precision;
        of_error.kernels = engine.kernels;
        of_error.instructions = engine.instructions;
        const auto lpips = load_lpips(settings_.lpips);
        of_error.lpips = lpips.get();
        SpeedRow row{stages.model,
                     stages.engine,
                     "50ms",
                     sensor,
                     stages.encode.time.cpu_ms.median,
                     stages.fresh.time.cpu_ms.median,
                     codes_against_double(model, windows, how),
                     measure_pipeline(data, of_error, program_.signals).error};
        return row;
    }

    /// The first model again with event windows of other lengths: more of them, nearer to the truth
    /// where things move.
    void shorter_windows(Report& report) {
        if (report.speed.empty()) return;
        const auto lpips = load_lpips(settings_.lpips);
        const auto data =
            simulated_packets(settings_.scene, parse_size(settings_.sizes[0]), settings_.seconds);
        for (const int length_ms : {12, 25, 100}) {
            const std::string window = std::to_string(length_ms) + "ms";
            if (stopping("event windows of " + window)) return;
            PipelineBenchSettings how = pipeline_settings(settings_.models[0]);
            how.window = window;
            how.rate = {kImagesPerSecond, 1};
            how.lpips = lpips.get();
            const PipelineBench run = measure_pipeline(data, how, program_.signals);
            SpeedRow row;
            row.model = run.model;
            row.engine = run.engine;
            row.window = window;
            row.sensor = run.sensor;
            row.encode_ms = milliseconds(run.counters.encode.p50);
            row.render_ms = milliseconds(run.counters.render.p50);
            row.error = run.error;
            report.speed.push_back(row);
        }
    }

    /// Of this program, run by itself on the simulated camera.
    double resident_mib(const std::string& model, const std::string& size) const {
        std::vector<std::string> words{"eventide",
                                       "run",
                                       "sim:demo?speed=max&seconds=1&size=" + size,
                                       "--out",
                                       "null",
                                       "--lookahead",
                                       "0",
                                       "--quiet",
                                       "--model",
                                       model,
                                       "--precision",
                                       settings_.precisions[0],
                                       "--engine",
                                       show_word(settings_.engine, kEngineWords),
                                       "--threads",
                                       std::to_string(settings_.threads)};
        std::vector<char*> arguments;
        arguments.reserve(words.size() + 1);
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        pid_t child = 0;
        if (posix_spawn(&child, "/proc/self/exe", nullptr, nullptr, arguments.data(), environ) != 0)
            return 0;
        int status = 0;
        rusage usage{};
        if (wait4(child, &status, 0, &usage) != child || status != 0) return 0;
        return double(usage.ru_maxrss) / 1024;
    }

    const BenchSettings& settings_;
    Program& program_;
    Progress progress_;
};

}  // namespace

/// Built-in kernels where instructions are left out: oneDNN's do not ask us.
std::vector<EngineOptions> engines_of(const BenchSettings& settings, const bench::Peaks& peaks) {
    if (settings.engine == Engine::plain) return {{.engine = Engine::plain}};
    const auto asks = [&](Precision wanted) {
        return std::ranges::any_of(settings.precisions, [&](const std::string& text) {
            return parse_word(text, kPrecisionWords) == wanted;
        });
    };
    const bool any = asks(Precision::automatic);
    std::vector<EngineOptions> all;
    if (any || asks(Precision::f32)) {
        all.push_back({.precision = Precision::f32,
                       .kernels = Kernels::own,
                       .instructions = std::max(settings.instructions, Instructions::avx2)});
        if (peaks.f32_avx512 > 0)
            all.push_back({.precision = Precision::f32, .instructions = settings.instructions});
    }
    if ((any && peaks.bf16 > 0) || asks(Precision::bf16))
        all.push_back({.precision = Precision::bf16, .instructions = settings.instructions});
    return all;
}

void mark_front(std::vector<SpeedRow>& rows) {
    constexpr double kAlike = .005;  // errors this near to each other do not decide
    const auto beats = [](const SpeedRow& a, const SpeedRow& b) {
        const double mse = a.error.raw.mse / b.error.raw.mse;
        return (a.total_ms() < b.total_ms() && mse <= 1 + kAlike) ||
               (a.total_ms() <= b.total_ms() && mse < 1 - kAlike);
    };
    for (SpeedRow& row : rows)
        row.is_on_front = std::ranges::none_of(rows, [&](const SpeedRow& other) {
            return other.sensor == row.sensor && beats(other, row);
        });
}

Report measure_report(const BenchSettings& settings, const std::vector<PeerRow>& peers,
                      Program& program) {
    Report report;
    report.machine = processor_text();
    report.program = "eventide " + version() + ", " + compiler_text();
    report.settings = "scene " + settings.scene + ", lookahead " +
                      std::to_string(settings.lookahead) + ", threads " +
                      (settings.threads == 0 ? "all" : std::to_string(settings.threads)) +
                      ", instructions " + show_word(settings.instructions, kInstructionWords);
    report.peers = peers;
    Measurement measurement{settings, program};
    measurement.memory(report);  // first: the system counts what this process held before, too
    report.peaks = bench::measure_peaks(settings.instructions);
    if (const auto lpips = load_lpips(settings.lpips)) report.lpips_name = lpips->name();
    measurement.speed(report);
    measurement.rates(report);
    measurement.activity(report);
    measurement.loads(report);
    return report;
}

}  // namespace eventide::app
