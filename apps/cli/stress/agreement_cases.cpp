// Every way of computing the same thing, against double precision and each other.
#include "apps/cli/stress/stress_case.h"
#include "src/core/list_text.h"
#include "src/nn/backend.h"
#include "src/nn/onednn_conv.h"

#include <atomic>
#include <thread>

namespace eventide::stress {
namespace {

constexpr SensorDuration kSecond{1'000'000};

/// bf16 keeps 8 bits of each factor; root mean square over all codes and frames of a run.
constexpr double kBf16Bound = .02;

PipelineOutcome measured(const Bench& bench, const EngineOptions& engine) {
    PipelineRunSettings how = bench.run_settings();
    how.engine = engine;
    how.sampling = bench.sampling();
    const auto length = bench.budget.length(SensorDuration{5 * kSecond}, kSecond);
    return run_pipeline(bench.model,
                        all_of(moving_edge(how.width, how.height, {}, SensorTime{length})), how);
}

EngineOptions with(const Bench& bench, Precision precision, Kernels kernels) {
    EngineOptions engine = bench.engine;
    engine.precision = precision;
    engine.kernels = kernels;
    return engine;
}

void add(const PipelineOutcome& outcome, const std::string& name, Result& result) {
    const Result one = judged(outcome, "");
    add_to_list(result.happened, name + " " + short_number(*one.error) + one.happened);
    result.passed &= one.passed;
    result.error = std::max(result.error.value_or(0), *one.error);
    result.bound = kFloatBound;
}

/// Worst numbers in float32.
Result float_kernels(const Bench& bench) {
    Result result;
    EngineOptions plain = bench.engine;
    plain.engine = Engine::plain;
    add(measured(bench, plain), "plain", result);
    add(measured(bench, with(bench, Precision::f32, Kernels::own)), "built-in", result);
    if (onednn_available())
        add(measured(bench, with(bench, Precision::f32, Kernels::onednn)), "oneDNN", result);
    return result;
}

Result instruction_sets(const Bench& bench) {
    Result result;
    const Instructions most = bench.engine.instructions;
    for (const Instructions each : {Instructions::sse4, Instructions::avx2, most}) {
        if (each < most) continue;  // the enumerators go down
        EngineOptions engine = with(bench, Precision::f32, Kernels::own);
        engine.instructions = each;
        const PipelineOutcome outcome = measured(bench, engine);
        add(outcome, outcome.engine, result);
    }
    return result;
}

/// Root mean square: single numbers may be further away.
Result bf16(const Bench& bench) {
    Result result;
    result.bound = kBf16Bound;
    const auto note = [&](const char* name, const EngineOptions& engine) {
        const PipelineOutcome outcome = measured(bench, engine);
        const double rms = std::max(outcome.codes.rms(), outcome.frames.rms());
        result.happened += (result.happened.empty() ? "RMS: " : ", ") + std::string{name} + " " +
                           short_number(rms) + outcome.error;
        result.error = std::max(result.error.value_or(0), rms);
        result.passed &= outcome.error.empty() && rms <= kBf16Bound;
    };
    EngineOptions emulated = with(bench, Precision::automatic, Kernels::own);
    emulated.emulate_bf16 = true;
    note("emulated", emulated);
    const bool has_bf16 = bf16_kernels(bench.engine.instructions) != nullptr;
    if (has_bf16) note("built-in", with(bench, Precision::bf16, Kernels::own));
    if (has_bf16 && onednn_has_bf16())
        note("oneDNN", with(bench, Precision::bf16, Kernels::onednn));
    return result;
}

/// So many threads, however few cores there are.
ParallelFor threads(int count) {
    return [count](int n, const std::function<void(int)>& body) {
        std::atomic<int> next{0};
        const auto work = [&] {
            for (int i = next++; i < n; i = next++) body(i);
        };
        std::vector<std::jthread> others;
        for (int i = 1; i < std::min(count, n); ++i) others.emplace_back(work);
        work();
    };
}

Result thread_counts(const Bench& bench) {
    Result result;
    std::optional<std::uint64_t> alone;
    bool same = true;
    const auto length = bench.budget.length(SensorDuration{kSecond}, kSecond / 5);
    for (const int count : {1, 2, 16})
        for (const bool threaded : {false, true}) {
            PipelineRunSettings how = bench.run_settings();
            how.width = 97;  // many tiles of odd sizes
            how.height = 71;
            how.engine.parallel_for = threads(count);
            how.threaded = threaded;
            how.lookahead = 1;
            const auto events = moving_edge(how.width, how.height, {}, SensorTime{length});
            const PipelineOutcome outcome = run_pipeline(bench.model, all_of(events), how);
            if (!alone) alone = outcome.bits;
            same &= outcome.bits == *alone && outcome.error.empty();
            result.happened = counted(outcome.counters.frames, "frames");
        }
    result.happened += " by 1, 2 and 16 threads, the pipeline on one thread and on four: " +
                       std::string{same ? "the same bits" : "other bits"};
    result.expect(same, "the same");
    return result;
}

}  // namespace

std::vector<Case> agreement_cases() {
    return {{"float32", "plain, built-in and oneDNN kernels, float32", float_kernels},
            {"instructions", "SSE4, AVX2 and the best, float32", instruction_sets},
            {"bf16", "bfloat16", bf16},
            {"threads", "one thread, two, sixteen", thread_counts}};
}

}  // namespace eventide::stress
