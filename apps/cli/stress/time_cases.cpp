// Times that are large, wrap, or go back.
#include "apps/cli/stress/stress_case.h"
#include "apps/cli/stress/wire_words.h"
#include "src/codec/text/text.h"
#include "src/core/list_text.h"

#include <cstdio>

namespace eventide::stress {
namespace {

constexpr SensorDuration kSecond{1'000'000};

std::vector<Event> moved(std::vector<Event> events, SensorDuration by) {
    for (Event& event : events) event.t += by;
    return events;
}

/// The same frames as from time 0, bit for bit, and near double precision.
Result from_time(const Bench& bench, SensorTime begin) {
    PipelineRunSettings how = bench.run_settings();
    const auto events = moving_edge(how.width, how.height, {}, SensorTime{2 * kSecond});
    const PipelineOutcome at_zero = run_pipeline(bench.model, all_of(events), how);
    how.sampling = bench.sampling();
    const PipelineOutcome there =
        run_pipeline(bench.model, all_of(moved(events, begin.time_since_epoch())), how);
    const bool same = there.bits == at_zero.bits;
    Result result =
        judged(there, counted(there.counters.frames, "frames; ") +
                          (same ? "the bits of a stream from 0" : "other bits than from 0"));
    result.expect(same, "the same bits");
    return result;
}

Result epoch(const Bench& bench) {
    return from_time(bench, from_us(1'700'000'000'000'000));
}
Result far_future(const Bench& bench) {
    return from_time(bench, from_us((std::int64_t{1} << 62) - 3'000'000));
}

/// 3 s of motion through the words of each camera and file, across a wrap of its counter.
Result wraps(const Bench& bench) {
    std::string happened;
    bool all_same = true;
    std::uint64_t damaged = 0;
    for (const Wire& wire : wires()) {
        PipelineRunSettings how = bench.run_settings();
        how.width = wire.width;
        how.height = wire.height;
        how.fps = "2";
        how.window = "500ms";
        const auto length = bench.budget.length(SensorDuration{3 * kSecond}, 2 * kSecond);
        // A part of the sensor: what is asked about is time.
        const auto events =
            moved(moving_edge(24, 16, {}, SensorTime{length}), SensorDuration{wire.begin_us});
        EncodedStream source{wire.width, wire.height, wire.bytes(events), wire.make_parser};
        const PipelineOutcome through = run_pipeline(bench.model, source, how);
        const PipelineOutcome direct = run_pipeline(bench.model, all_of(events), how);
        const bool same = through.bits == direct.bits && through.error.empty() &&
                          through.counters.events == events.size();
        all_same &= same;
        damaged += through.counters.damaged.total();
        add_to_list(happened, wire.name + " (" + wire.wraps + ")" + (same ? "" : " DIFFERS"));
    }
    Result result;
    result.happened =
        "frames across a wrap of " + happened + ": the bits of times that do not wrap";
    result.expect(all_same, "the same bits");
    result.expect(damaged == 0, "nothing damaged");
    return result;
}

/// A camera's clock that begins anew so much earlier: a new stream, as bit for bit as the first.
Result clock_back(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    std::vector<Event> events =
        moved(moving_edge(how.width, how.height, {}, SensorTime{kSecond}), 7200 * kSecond);
    std::string happened;
    std::optional<Result> worst;
    for (const SensorDuration back : {SensorDuration{1}, 3600 * kSecond}) {
        std::vector<Event> both = events;
        const SensorTime again = events.back().t - back;
        for (const Event& event : events)
            both.push_back(
                {again + (event.t - events.front().t), event.x, event.y, event.polarity});
        const PipelineOutcome outcome = run_pipeline(bench.model, all_of(std::move(both)), how);
        Result result =
            judged(outcome, counted(outcome.counters.slicing.time_resets, "new stream, ") +
                                counted(outcome.counters.frames, "frames"));
        // Behind an event that was left out as noise, 1 us back is no step back.
        const bool may_pass = bench.model.config.noise_filter && back == SensorDuration{1};
        const std::uint64_t resets = outcome.counters.slicing.time_resets;
        result.expect(resets == 1 || (resets == 0 && may_pass), "one new stream");
        worst = worst ? worse(*worst, result) : result;
    }
    return *worst;
}

/// Rows of text, the times of which go back: what comes a little late is put in order, what comes
/// an hour late is left out and counted.
Result text_back(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    const auto events =
        moved(moving_edge(how.width, how.height, {}, SensorTime{kSecond}), 7200 * kSecond);
    std::string rows;
    std::size_t late = 0;
    for (std::size_t i = 0; i < events.size(); ++i) {
        const Event& e = events[i];
        const std::int64_t back = i % 10 == 3 ? 1 : i % 100 == 57 ? 3'600'000'000 : 0;
        late += back > 1 ? 1 : 0;
        char row[64];
        std::snprintf(row, sizeof row, "%lld %d %d %d\n", (long long)(to_us(e.t) - back), e.x, e.y,
                      int(e.polarity));
        rows += row;
    }
    const auto bytes = std::as_bytes(std::span{rows});
    EncodedStream source{
        how.width, how.height, {bytes.begin(), bytes.end()}, [&]() -> std::unique_ptr<Parser> {
            TextLayout layout;
            layout.unit = TextTimeUnit::microseconds;
            return std::make_unique<TextParser>(layout, how.width, how.height);
        }};
    const PipelineOutcome outcome = run_pipeline(bench.model, source, how);
    const std::uint64_t dropped = outcome.counters.damaged[DamageReason::time_backwards];
    Result result = judged(outcome, "every tenth row 1 us early: in order; " +
                                        counted(dropped, "rows an hour early: left out, counted"));
    result.expect(dropped == late, counted(late, "left out"));
    result.expect(outcome.counters.events == events.size() - late, "all others taken");
    return result;
}

}  // namespace

std::vector<Case> time_cases() {
    return {{"epoch-stamps", "times of 1.7e15 us", epoch},
            {"far-stamps", "times near 2^62 us", far_future},
            {"counters-wrap", "each sensor's counter wrapping", wraps},
            {"clock-back", "camera's clock back by 1 us and by an hour", clock_back},
            {"text-back", "text: time back by 1 us and by an hour", text_back}};
}

}  // namespace eventide::stress
