// Sensors and frames of unusual sizes, unusual rates, and queries on edges.
#include "apps/cli/run/report/memory_use.h"
#include "apps/cli/stress/process_size.h"
#include "apps/cli/stress/stress_case.h"
#include "apps/cli/stress/worst.h"

#include <algorithm>
#include <cmath>

namespace eventide::stress {
namespace {

constexpr SensorDuration kSecond{1'000'000};

Result small_sensor(const Bench& bench, int width, int height) {
    PipelineRunSettings how = bench.run_settings();
    how.width = width;
    how.height = height;
    how.sampling = Sampling{20, 3, 50, 3};
    const auto length = bench.budget.length(SensorDuration{2 * kSecond}, kSecond / 2);
    const auto events = moving_edge(width, height, {}, SensorTime{length});
    const PipelineOutcome outcome = run_pipeline(bench.model, all_of(events), how);
    return judged(outcome, counted(outcome.counters.frames, "frames"));
}

constexpr int kPatch = 48;  // px

/// The same events in two squares far from each other and from the edges, after one in a corner:
/// the first of a stream is never filtered.
std::vector<Event> twice(int x1, int x2, int y) {
    std::vector<Event> events{{SensorTime{}, 0, 0, Polarity::on}};
    for (const Event& e : moving_edge(kPatch, kPatch, {}, SensorTime{kSecond / 5}))
        for (const int x : {x1, x2})
            events.push_back({e.t, std::uint16_t(x + e.x), std::uint16_t(y + e.y), e.polarity});
    return events;
}

double difference(const Array2<float>& map, int x1, int x2, int y) {
    double worst = 0;
    for (int j = 0; j < kPatch; ++j)
        for (int i = 0; i < kPatch; ++i)
            worst =
                worst_of(worst, std::abs(double(map(y + j, x1 + i)) - double(map(y + j, x2 + i))));
    return worst;
}

/// Too large for double precision. A network that is right everywhere shows the same thing for the
/// same events in two places, neither of which is near an edge.
Result large_sensor(const Bench& bench, int width, int height) {
    SensorInfo sensor;
    sensor.width = width;
    sensor.height = height;
    constexpr Precision kPrecision = Precision::f32;  // that takes the most
    const ModelConfig& config = bench.model.config;
    const std::uint64_t bytes = app::network_bytes(config, sensor, kPrecision) +
                                app::buffer_bytes(config, sensor, run_buffers(false), kPrecision);
    Result result;
    if (bytes + bytes / 2 > free_memory()) {
        result.happened = "not run: takes " + counted((bytes + bytes / 2) >> 20, "MiB, ") +
                          counted(free_memory() >> 20, "are free");
        result.ran = false;
        return result;
    }
    PipelineRunSettings how = bench.run_settings();
    how.width = width;
    how.height = height;
    how.fps = "frame";
    // Whole steps of the deepest level apart.
    const int x1 = (width / 4) / 64 * 64, x2 = (width * 3 / 4 - kPatch) / 64 * 64;
    const int y = (height / 2) / 64 * 64;
    const PipelineOutcome outcome = run_pipeline(bench.model, all_of(twice(x1, x2, y)), how);
    result = judged(outcome, counted(outcome.counters.event_windows, "windows; ") +
                                 "the same events in two places give the same frame");
    if (outcome.last.intensity.empty()) return result;
    result.error = worst_of(difference(outcome.last.intensity, x1, x2, y),
                            difference(outcome.last.sigma, x1, x2, y));
    result.bound = kFloatBound;
    result.expect(*result.error <= *result.bound, "the same");
    return result;
}

Result output(const Bench& bench,
              const std::function<FrameSize(const PipelineRunSettings&)>& size) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = Sampling{20, 3, 50, 1};
    how.size = size(how);
    how.fps = "20";
    const auto length = bench.budget.length(SensorDuration{kSecond}, kSecond / 5);
    const auto events = moving_edge(how.width, how.height, {}, SensorTime{length});
    const PipelineOutcome outcome = run_pipeline(bench.model, all_of(events), how);
    return judged(outcome, counted(outcome.counters.frames, "frames of ") +
                               std::to_string(outcome.last.intensity.width()) + "x" +
                               std::to_string(outcome.last.intensity.height()));
}

Result one_pixel(const Bench& bench) {
    return output(bench, [](const PipelineRunSettings&) { return FrameSize{1, 1, {}}; });
}
Result eight_times(const Bench& bench) {
    return output(bench, [](const PipelineRunSettings& how) {
        return FrameSize{8 * how.width, 8 * how.height, {}};
    });
}
Result widest(const Bench& bench) {
    return output(bench, [](const PipelineRunSettings&) {
        return FrameSize{kLargestFrameSide, 24, {}};
    });
}
/// Every second column and row lies on a pixel exactly, the others half way.
Result on_pixels(const Bench& bench) {
    return output(bench, [](const PipelineRunSettings& how) {
        return FrameSize{2 * how.width - 1, 2 * how.height - 1, {}};
    });
}

/// Frames at the very begin and end of windows, at every lookahead.
Result on_edges(const Bench& bench) {
    std::optional<Result> worst;
    std::uint64_t frames = 0;
    for (const int lookahead : {0, 1, 2})
        for (const char* fps : {"20", "frame"}) {
            PipelineRunSettings how = bench.run_settings();
            how.sampling = bench.sampling();
            how.sampling->frames_every = 2;
            how.lookahead = lookahead;
            how.fps = fps;
            const auto length = bench.budget.length(SensorDuration{kSecond}, kSecond / 4);
            const auto events = moving_edge(how.width, how.height, {}, SensorTime{length});
            const PipelineOutcome outcome = run_pipeline(bench.model, all_of(events), how);
            const Result result = judged(outcome, "");
            frames += outcome.counters.frames;
            worst = worst ? worse(*worst, result) : result;
        }
    worst->happened = counted(frames, "frames, lookahead 0, 1 and 2") + worst->happened;
    return *worst;
}

/// One frame every 1000 s.
Result slowest(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    how.sampling->frames_every = 1;
    how.fps = "0.001";
    const SensorDuration each = bench.budget.length(kSecond, kSecond / 5);
    auto events = moving_edge(how.width, how.height, {}, SensorTime{each});
    for (int k = 1; k <= 4; ++k) {
        const auto more = moving_edge(how.width, how.height, SensorTime{k * 1000 * kSecond},
                                      SensorTime{k * 1000 * kSecond + kSecond / 5});
        events.insert(events.end(), more.begin(), more.end());
    }
    const PipelineOutcome outcome = run_pipeline(bench.model, all_of(std::move(events)), how);
    Result result = judged(outcome, counted(outcome.counters.frames, "frames of ") +
                                        counted(outcome.counters.event_windows, "windows"));
    result.expect(outcome.counters.frames == 5, "five frames");
    return result;
}

Result fastest(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    how.sampling->frames_every = 101;
    how.fps = "100000";
    const auto length = bench.budget.length(SensorDuration{150'000}, SensorDuration{10'000});
    const auto events = moving_edge(how.width, how.height, {}, SensorTime{length});
    const PipelineOutcome outcome = run_pipeline(bench.model, all_of(events), how);
    Result result = judged(outcome, counted(outcome.counters.frames, "frames of ") +
                                        counted(outcome.counters.event_windows, "windows"));
    const std::int64_t span = (events.back().t - events.front().t).count() + 1;
    result.expect(outcome.counters.frames == std::uint64_t(span / 10 + 1), "one each 10 us");
    return result;
}

Case sensor(const std::string& size, std::function<Result(const Bench&)> run,
            bool in_quick_form = true) {
    return {"sensor-" + size, "sensor of " + size + " px", std::move(run), true, in_quick_form};
}

}  // namespace

std::vector<Case> size_cases() {
    return {
        sensor("1x1", [](const Bench& bench) { return small_sensor(bench, 1, 1); }),
        sensor("1x640", [](const Bench& bench) { return small_sensor(bench, 1, 640); }),
        sensor("17x13", [](const Bench& bench) { return small_sensor(bench, 17, 13); }),
        sensor(
            "1280x720", [](const Bench& bench) { return large_sensor(bench, 1280, 720); }, false),
        sensor(
            "4096x4096", [](const Bench& bench) { return large_sensor(bench, 4096, 4096); }, false),
        {"frame-1x1", "frames of 1x1 px", one_pixel},
        {"frame-8x", "frames of 8 times the sensor", eight_times},
        {"frame-16384", "frames 16384 px wide", widest},
        {"on-pixels", "queries exactly on pixels and between", on_pixels},
        {"on-edges", "queries exactly on edges of windows", on_edges},
        {"fps-0.001", "0.001 frames/s", slowest},
        {"fps-1e5", "10^5 frames/s", fastest}};
}

}  // namespace eventide::stress
