// Event windows that are short, long, nearly empty or full, and bins few and many.
#include "apps/cli/stress/stress_case.h"

#include <random>

namespace eventide::stress {
namespace {

constexpr SensorDuration kSecond{1'000'000};

std::string windows_of(const PipelineOutcome& outcome) {
    return counted(outcome.counters.event_windows, "windows, ") +
           counted(outcome.counters.events, "events");
}

Result microseconds(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = Sampling{50, 3, 200, 5};
    how.window = "1us";
    how.fps = "frame";
    const auto length = bench.budget.length(SensorDuration{5000}, SensorDuration{200});
    std::vector<Event> events;
    for (int us = 1; us <= length.count(); ++us)
        for (int n = 0; n < 3; ++n)
            events.push_back({from_us(us), std::uint16_t(us / 40 % how.width),
                              std::uint16_t((us + 7 * n) % how.height),
                              us % 3 == 0 ? Polarity::off : Polarity::on});
    const PipelineOutcome outcome = run_pipeline(bench.model, all_of(std::move(events)), how);
    Result result = judged(outcome, windows_of(outcome));
    result.expect(outcome.counters.event_windows == std::uint64_t(length.count()),
                  "one window each microsecond");
    return result;
}

Result an_hour(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    how.window = "3600s";
    how.fps = "1/600";
    const SensorDuration length = 4 * 3600 * kSecond;
    const std::int64_t step = bench.budget.length(10'000, 1'000'000);
    std::int64_t at = 0;
    const auto make = [=, width = how.width, height = how.height](auto& into) mutable {
        for (int n = 0; n < 10'000 && at < length.count(); ++n, at += step)
            into.push_back({from_us(at + 1), std::uint16_t(at / step % width),
                            std::uint16_t(at / step / width % height),
                            at / step % 5 < 2 ? Polarity::off : Polarity::on});
    };
    const PipelineOutcome outcome = run_pipeline(bench.model, make, how);
    return judged(outcome, windows_of(outcome));
}

Result one_event_each(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = Sampling{50, 3, 100, 5};
    how.window = "1ev";
    how.fps = "frame";
    const auto length = bench.budget.length(SensorDuration{2 * kSecond}, kSecond / 5);
    const auto events = moving_edge(how.width, how.height, {}, SensorTime{length});
    const PipelineOutcome outcome = run_pipeline(bench.model, all_of(events), how);
    return judged(outcome, windows_of(outcome));
}

/// At random, so that nothing seems to flicker. In the quick form so many fewer.
Result ten_million_events(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    const std::int64_t each = bench.budget.length(10'000'000, 100'000);
    how.window = std::to_string(each) + "ev,60s";
    how.fps = "frame";
    std::int64_t at = 0;
    std::mt19937 random{1};
    const auto make = [=, width = unsigned(how.width),
                       height = unsigned(how.height)](auto& into) mutable {
        for (int n = 0; n < 50'000 && at < 2 * each; ++n, ++at)
            into.push_back({from_us(at + 1), std::uint16_t(random() % width),
                            std::uint16_t(random() % height),
                            random() % 7 < 3 ? Polarity::off : Polarity::on});
    };
    const PipelineOutcome outcome = run_pipeline(bench.model, make, how);
    Result result = judged(outcome, windows_of(outcome));
    result.expect(outcome.counters.event_windows == 2, "two windows");
    return result;
}

/// The model with other bins. What reads the grid takes its channels again and again, weighted so
/// that sums keep their size; it was not trained for that, and needs not be.
Model rebinned(const Model& model, int bins) {
    Model other = model;
    other.config.bins = bins;
    for (const auto& [name, shape] : expected_tensors(other.config)) {
        const Tensor& from = model.weights.at(name);
        if (shape == from.shape) continue;  // else [out][channel of the grid][y][x]
        Tensor& to = other.weights.at(name);
        to.shape = shape;
        to.values.resize(element_count(shape));
        const auto taps = std::size_t(shape[2] * shape[3]), had = std::size_t(from.shape[1]),
                   has = std::size_t(shape[1]);
        for (std::size_t i = 0; i < to.values.size(); ++i) {
            const std::size_t tap = i % taps, channel = i / taps % has, out = i / taps / has;
            to.values[i] =
                from.values[(out * had + channel % had) * taps + tap] * float(had) / float(has);
        }
    }
    return other;
}

Result with_bins(const Bench& bench, int bins) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    const Model model = rebinned(bench.model, bins);
    const auto length = bench.budget.length(SensorDuration{2 * kSecond}, kSecond / 2);
    const auto events = moving_edge(how.width, how.height, {}, SensorTime{length});
    const PipelineOutcome outcome = run_pipeline(model, all_of(events), how);
    return judged(outcome, windows_of(outcome));
}

}  // namespace

std::vector<Case> window_cases() {
    return {{"window-1us", "windows of 1 us", microseconds},
            {"window-1h", "windows of an hour", an_hour},
            {"window-1ev", "windows of 1 event", one_event_each},
            {"window-1e7ev", "windows of 10^7 events", ten_million_events},
            {"bins-1", "1 bin", [](const Bench& bench) { return with_bins(bench, 1); }},
            {"bins-64", "64 bins", [](const Bench& bench) { return with_bins(bench, 64); }}};
}

}  // namespace eventide::stress
