// A scene that stops: what becomes of the image while no events come.
#include "apps/evaluate/figure_sequences.h"
#include "src/metrics/image_measures.h"

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {

/// Of each sequence the change of intensity since the stop, by number of silent event windows.
using ChangeBySilence = std::map<int, double>;

Plot plot_of_change(const std::vector<ChangeBySilence>& moved,
                    const std::vector<int>& silent_windows) {
    Series change{"model", {}, {}, {}};
    for (const int silent : silent_windows) {
        double sum = 0;
        for (const ChangeBySilence& one : moved) sum += one.at(silent);
        change.x.push_back(silent);
        change.y.push_back(sum / double(moved.size()));
    }
    return {.name = "silence_change",
            .title = "a scene that stops",
            .x_label = "event windows without events",
            .y_label = "root mean square change of intensity",
            .series = {change},
            .log_x = true};
}

/// Nothing moves any more, and the sensor is without noise: empty event windows.
void push_silence(ModelRun& run, SensorTime stop, SensorDuration width, int windows) {
    for (int s = 0; s < windows; ++s)
        run.push({.window = {stop + s * width, stop + (s + 1) * width}, .events = {}});
}

}  // namespace

std::vector<Plot> error_against_silence(const FigureSettings& what, const EvaluateSettings& how) {
    FigureSettings moving = what;
    moving.simulated.event_windows = what.moving_windows;
    std::ranges::sort(moving.silent_windows);
    const FigureSequences sequences{"silence", moving, how};
    const SensorDuration window_width = what.simulated.frame_width;
    std::vector<ChangeBySilence> moved(std::size_t(what.simulated.sequences));

    const FigureScores scores = sequences.run_each([&](int i, FigureScores& found) {
        Judge judge = sequences.make_judge();
        SensorTime stop{};
        Array2<float> at_stop;
        ModelRun run = sequences.make_run([&](const Query& query, const Frame& frame) {
            const auto silent = int((query.t - stop) / window_width);
            if (at_stop.empty()) at_stop = clipped(frame.intensity);
            moved[std::size_t(i)][silent] =
                std::sqrt(mean_squared_error(clipped(frame.intensity), at_stop));
            found[{"model", silent}].push_back(
                judge.judge(frame.intensity, frame.sigma, query.truth));
        });
        Query last;
        sequences.push_windows(
            i, run, [&](const EventWindow& event_window, const SimulatedStream& stream) {
                stop = event_window.window.end;
                last = truth_query(stream, stop, sequences.width(), sequences.height());
            });
        for (const int silent : moving.silent_windows) {
            Query query = last;
            query.t = stop + silent * window_width;
            run.ask(std::move(query));
        }
        push_silence(run, stop, window_width, moving.silent_windows.back() + how.lookahead);
        run.finish();
    });
    std::vector<Plot> plots = sequences.plots_of(
        scores, {"silence", "a scene that stops", "event windows without events", true});
    plots.push_back(plot_of_change(moved, moving.silent_windows));
    return plots;
}

}  // namespace eventide
