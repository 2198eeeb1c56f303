// Too little to see, too much, and noise.
#include "apps/cli/stress/frame_change.h"
#include "apps/cli/stress/still_scene.h"
#include "apps/cli/stress/stress_case.h"

#include <algorithm>

namespace eventide::stress {
namespace {

constexpr SensorDuration kSecond{1'000'000};
constexpr SensorDuration kHour = 3600 * kSecond;

/// Whether a scene is to be kept while nothing moves. The thesis' network, the reference, has no
/// gate: each event window changes its state everywhere, and what becomes of a scene is told only.
bool keeps_scenes(const Model& model) {
    return model.config.encoder == EncoderKind::gated;
}

/// The first event of the next hours ends the silence; more frames in a row without events would be
/// refused without --allow-silence.
Result silence(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    how.fps = "1/10";
    constexpr SensorDuration kMoving{20 * kSecond};
    const SensorTime end{bench.budget.length(9 * kHour, kHour / 6)};
    std::vector<Event> events = moving_edge(how.width, how.height, {}, SensorTime{kMoving});
    events.push_back({end, 3, 3, Polarity::on});
    Array2<float> before;
    FrameChange after;
    how.on_frame = [&](const Frame& frame) {
        if (frame.t <= SensorTime{kMoving})
            before = frame.intensity;
        else if (frame.t < end)
            after = change_between(before, frame.intensity);
    };
    const PipelineOutcome outcome = run_pipeline(bench.model, all_of(std::move(events)), how);
    Result result =
        judged(outcome, short_number(double(to_us(end)) / 3.6e9) + " h between two events, " +
                            counted(outcome.counters.frames, "frames") +
                            "; the last against the one before it: " + words_of(after));
    if (keeps_scenes(bench.model)) result.expect(is_kept(after), "kept");
    return result;
}

Result one_event(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.sampling = bench.sampling();
    how.fps = "frame";
    const PipelineOutcome outcome =
        run_pipeline(bench.model, all_of({{SensorTime{kSecond}, 7, 5, Polarity::on}}), how);
    Result result = judged(outcome, counted(outcome.counters.frames, "frame of one event"));
    result.expect(outcome.counters.event_windows == 1, "one event window");
    return result;
}

/// 10 ms in which every pixel has an event in every microsecond, after a second of motion.
Result every_pixel(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.width = 24;
    how.height = 16;
    how.sampling = bench.sampling();
    const std::int64_t burst_us = bench.budget.length(10'000, 500);
    auto quiet = std::make_shared<std::vector<Event>>(
        moving_edge(how.width, how.height, {}, SensorTime{kSecond}));
    std::int64_t at = 0;
    const auto make = [=, width = how.width, height = how.height](auto& into) mutable {
        if (at == 0) into = *quiet;
        for (int n = 0; n < 100 && at < burst_us; ++n, ++at)
            for (int p = 0; p < width * height; ++p)
                into.push_back({SensorTime{kSecond} + SensorDuration{1 + at},
                                std::uint16_t(p % width), std::uint16_t(p / width),
                                (p + at) % 3 == 0 ? Polarity::off : Polarity::on});
    };
    const PipelineOutcome outcome = run_pipeline(bench.model, make, how);
    Result result = judged(outcome, counted(outcome.counters.events, "events, ") +
                                        std::to_string(burst_us) + " us of all pixels");
    result.expect(outcome.counters.slicing.too_many == 0, "no event left out");
    return result;
}

/// 1 % of the pixels fire a million times a second together, before a scene that moves.
Result hot_pixels(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.width = 40;
    how.height = 30;
    how.sampling = Sampling{10, 3, 20, 2};
    const auto duration = bench.budget.length(SensorDuration{2 * kSecond}, kSecond / 5);
    const auto scene = moving_edge(how.width, how.height, {}, SensorTime{duration});
    std::size_t next = 0;
    std::int64_t at = 0;
    const auto make = [=](auto& into) mutable {
        for (int n = 0; n < 10'000 && at < duration.count(); ++n, ++at) {
            const int pixel = int(at % 12) * 97 + 5;  // 12 of 1200
            const SensorTime t = from_us(at + 1);
            for (; next < scene.size() && scene[next].t <= t; ++next) into.push_back(scene[next]);
            into.push_back({t, std::uint16_t(pixel % 40), std::uint16_t(pixel / 40),
                            at / 12 % 2 == 0 ? Polarity::on : Polarity::off});
        }
    };
    const PipelineOutcome outcome = run_pipeline(bench.model, make, how);
    return judged(outcome, counted(outcome.counters.events, "events in ") +
                               short_number(double(duration.count()) * 1e-6) + " s");
}

/// The frame may not fade.
Result still_scene(const Bench& bench) {
    PipelineRunSettings how = bench.run_settings();
    how.width = 64;
    how.height = 48;
    how.sampling = Sampling{3, 3, 4999, 1};
    how.fps = "1";
    constexpr SensorDuration kMoving{6 * kSecond};
    const SensorTime end{kMoving + bench.budget.length(SensorDuration{kHour}, 10 * kSecond)};
    StillScene scene{how.width, how.height, kMoving};
    const auto is_late = bench.budget.clock(.35);
    const SensorTime earliest_end{kMoving + 10 * kSecond};  // however slow: noise must be seen
    const auto make = [&](std::vector<Event>& into) {
        while (into.empty() && scene.now() < end && (scene.now() < earliest_end || !is_late()))
            scene.advance(into);
    };
    Array2<float> moving;
    FrameChange now, worst;
    SensorTime first_gone{};
    how.on_frame = [&](const Frame& frame) {
        if (frame.t < SensorTime{kMoving}) return;
        if (moving.empty()) {  // less than a second after the last motion
            moving = frame.intensity;
            return;
        }
        now = change_between(moving, frame.intensity);
        if (!is_kept(now) && first_gone == SensorTime{}) first_gone = frame.t;
        if (now.correlation < worst.correlation) worst = now;
    };
    const PipelineOutcome outcome = run_pipeline(bench.model, make, how);
    const double seconds = double((scene.now() - SensorTime{kMoving}).count()) * 1e-6;
    Result result =
        judged(outcome, short_number(seconds) + " s of noise, " +
                            counted(outcome.counters.events, "events; ") +
                            "against the last moving frame at the end: " + words_of(now) +
                            "; at the lowest correlation: " + words_of(worst));
    if (first_gone != SensorTime{} && keeps_scenes(bench.model))
        result.expect(false, "kept; out of bounds first after " +
                                 short_number(double(to_us(first_gone)) * 1e-6 - 6) + " s");
    return result;
}

}  // namespace

std::vector<Case> activity_cases() {
    return {{"silence", "silence for 9 hours", silence},
            {"one-event", "one event", one_event},
            {"every-pixel", "every pixel each microsecond for 10 ms", every_pixel},
            {"hot-pixels", "1 % hot pixels at 1e6 events/s", hot_pixels},
            {"still-scene", "still scene, sensor noise for an hour", still_scene}};
}

}  // namespace eventide::stress
