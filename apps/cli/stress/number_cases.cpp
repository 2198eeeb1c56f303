// A million steps, numbers that are tiny, huge or none.
#include "apps/cli/stress/stress_case.h"
#include "src/core/error.h"
#include "src/model/model_trial.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace eventide::stress {
namespace {

constexpr SensorDuration kSecond{1'000'000};

/// Minutes of motion with pauses of ten seconds.
Result million_steps(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.width = 24;
    how.height = 16;
    how.sampling = Sampling{20, 5, bench.budget.length(9973U, 101U), 1};  // primes: any phase
    how.fps = "1/5";
    how.window = "50ms";
    const std::int64_t steps = bench.budget.length(1'000'000, 600);
    const auto is_late = bench.budget.clock(.35);
    std::int64_t second = 0;
    double largest = 0;
    const auto make = [&](std::vector<Event>& into) {
        while (into.empty() && second * 20 < steps && !is_late()) {
            const SensorTime now{second * kSecond};
            if (second % 60 < 50)
                into =
                    moving_edge(how.width, how.height, now, now + kSecond, std::uint64_t(second));
            ++second;
        }
    };
    how.on_frame = [&](const Frame& frame) {
        for (const float v : frame.intensity.values())
            largest = std::max(largest, std::abs(double(v)));
    };
    const PipelineOutcome outcome = run_pipeline(bench.model, make, how);
    return judged(outcome, counted(outcome.counters.encoded, "steps (") +
                               short_number(double(second) / 3600) + " h of stream time, " +
                               counted(outcome.counters.events, "events); states within ") +
                               short_number(outcome.largest_state) + ", intensity within " +
                               short_number(largest));
}

/// All states, then all weights of the encoder, so small that their numbers have no leading bit.
Result denormals(const Bench& bench) {
    constexpr float kTiny = 3e-41F;
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    const auto events = moving_edge(how.width, how.height, {}, SensorTime{kSecond});
    Encoder encoder{bench.model, how.width, how.height, how.engine};
    how.state = encoder.state();
    for (auto& [name, tensor] : how.state->tensors) std::ranges::fill(tensor.values, kTiny);
    const PipelineOutcome of_state = run_pipeline(bench.model, all_of(events), how);
    Result first = judged(of_state, "states and weights of 3e-41");
    how.state.reset();
    Model model = bench.model;
    for (auto& [name, tensor] : model.weights)
        if (name.starts_with("encoder."))
            for (float& weight : tensor.values) weight = std::copysign(kTiny, weight);
    const Result second = judged(run_pipeline(model, all_of(events), how), "weights of 3e-41");
    return worse(first, second);
}

/// Single steps from the same state: where gates switch as hard as these, a rounding may decide.
constexpr double kScaledBound = 1e-3;

/// Every weight and bias times so much: refused when it is loaded, or near double precision.
Result scaled_weights(const Bench& bench) {
    Result result;
    result.bound = kScaledBound;
    for (const float scale : {1e-3F, 1e-2F, .1F, 10.F, 100.F, 1000.F}) {
        Model model = bench.model;
        for (auto& [name, tensor] : model.weights)
            for (float& weight : tensor.values) weight *= scale;
        result.happened += (result.happened.empty() ? "x " : ", x ") + short_number(scale) + ": ";
        try {
            try_model(model, "model");
        } catch (const Error&) {
            result.happened += "refused";
            continue;
        }
        PipelineRunSettings how = bench.run_settings();
        how.sampling = Sampling{0, 1, 2, 1};
        const auto events = moving_edge(how.width, how.height, {}, SensorTime{2 * kSecond});
        const PipelineOutcome outcome = run_pipeline(model, all_of(events), how);
        const Result one = judged(outcome, "", kScaledBound);
        result.happened += short_number(one.error.value_or(0)) + one.happened;
        result.passed &= one.passed;
        result.error = std::max(result.error.value_or(0), one.error.value_or(0));
    }
    return result;
}

constexpr float kNone[]{std::numeric_limits<float>::quiet_NaN(),
                        std::numeric_limits<float>::infinity(),
                        -std::numeric_limits<float>::infinity()};

/// What refused, or nothing.
template <typename Work>
std::string refusal(Work work) {
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

/// Puts each of kNone into one number of each tensor in turn: `use` must refuse it by the tensor's
/// name.
Result refused_by_name(Tensors& tensors, const std::function<void()>& use) {
    Result result;
    int refused = 0, tried = 0;
    for (auto& [name, tensor] : tensors)
        for (const float none : kNone) {
            float& number = tensor.values[tensor.values.size() / 2];
            const float before = std::exchange(number, none);
            const std::string words = refusal(use);
            number = before;
            ++tried;
            refused += words.find(name) != std::string::npos ? 1 : 0;
        }
    result.happened = std::to_string(refused) + " of " + std::to_string(tried) +
                      " refused with the tensor's name";
    result.expect(refused == tried, "all");
    return result;
}

Result none_in_weights(const Bench& bench) {
    Model model = bench.model;
    return refused_by_name(model.weights, [&] { check_model(model, "model"); });
}

Result none_in_state(const Bench& bench) {
    Encoder encoder{bench.model, 24, 16, bench.engine};
    TensorFile state = encoder.state();
    return refused_by_name(state.tensors, [&] {
        encoder.restore(parse_safetensors(format_safetensors(state), "state"), "state");
    });
}

bool is_finite(const TensorFile& file) {
    return std::ranges::all_of(file.tensors, [](const auto& named) {
        return std::ranges::all_of(named.second.values, [](float v) { return std::isfinite(v); });
    });
}

/// No input holds grids: events are binned into whole sums, and one that is not finite stands for a
/// fault of memory. So it need not be refused, but it may not stay: every channel in turn, at the
/// pixels that have events in one window.
Result none_in_grid(const Bench& bench) {
    Result result;
    int ended = 0, tried = 0, harmless = 0;
    const int channels = bench.model.config.input_channels();
    const int step = bench.budget.length(1, std::max(1, channels / 3));
    for (int channel = 0; channel < channels; channel += step)
        for (const float none : kNone) {
            PipelineRunSettings how = bench.run_settings();
            how.width = 24;
            how.height = 16;
            how.fps = "frame";
            int window = 0;
            how.on_grid = [&](VoxelGrid& grid) {
                if (window++ != 2) return;
                for (int p = 0; p < 24 * 16; ++p)
                    if (grid.touched(p / 24, p % 24) != 0)
                        grid.values(p / 24, p % 24, channel) = none;
            };
            const auto events = moving_edge(24, 16, {}, SensorTime{kSecond / 4});
            const PipelineOutcome outcome = run_pipeline(bench.model, all_of(events), how);
            ++tried;
            ended += outcome.error.find("finite") != std::string::npos ? 1 : 0;
            harmless += outcome.error.empty() && is_finite(outcome.state) ? 1 : 0;
        }
    result.happened = std::to_string(tried) + " runs: " + std::to_string(ended) +
                      " ended with an error that names the frame, " + std::to_string(harmless) +
                      " went on with finite frames and states";
    result.expect(ended + harmless == tried, "all of them either");
    return result;
}

}  // namespace

std::vector<Case> number_cases() {
    return {{"million-steps", "10^6 steps of the encoder", million_steps},
            {"denormals", "denormal states and weights", denormals},
            {"scaled-weights", "weights times 10^-3 to 10^3", scaled_weights},
            {"none-in-weights", "NaN or Inf in a weight", none_in_weights},
            {"none-in-state", "NaN or Inf in a state file", none_in_state},
            {"none-in-grid", "NaN or Inf in a grid", none_in_grid}};
}

}  // namespace eventide::stress
