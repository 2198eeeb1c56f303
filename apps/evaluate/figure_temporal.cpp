// Images within event windows, against blends of those at the windows' edges.
#include "apps/evaluate/figure_sequences.h"

#include <set>

namespace eventide {
namespace {

/// Where images lie in an event window that has 1 to `most` of them.
struct Phases {
    std::int64_t window_us = 0;
    int most = 0;

    /// Of image j of n, from 1, after the window's begin.
    std::int64_t offset_us(int j, int n) const { return (window_us * j + n / 2) / n; }

    /// Calls use(j, n) for each.
    template <typename Use>
    void for_each(Use use) const {
        for (int n = 1; n <= most; ++n)
            for (int j = 1; j <= n; ++j) use(j, n);
    }
    std::set<std::int64_t> offsets_us() const {
        std::set<std::int64_t> all;
        for_each([&](int j, int n) { all.insert(offset_us(j, n)); });
        return all;
    }
};

Array2<float> blend_of(const Array2<float>& from, const Array2<float>& to, float share) {
    Array2<float> blend = from;
    for (std::size_t p = 0; p < blend.values().size(); ++p)
        blend.values()[p] += share * (to.values()[p] - blend.values()[p]);
    return blend;
}

/// Judges one sequence's images, and once the last of a window is there, blends of its two edges.
class BetweenEdges {
public:
    BetweenEdges(const Phases& phases, Judge judge, FigureScores& found)
        : phases_{phases}, judge_{std::move(judge)}, found_{found} {}

    /// Without truth: the edge before a scored window.
    void use(const Query& query, const Frame& frame) {
        if (query.truth.empty()) {
            edge_ = frame.intensity;
            return;
        }
        const std::int64_t offset_us = (query.t - frame.window.begin).count();
        images_[offset_us] = {query.truth, judge_.judge(frame.intensity, frame.sigma, query.truth)};
        if (offset_us == phases_.window_us) compare_with_blends(frame.intensity);
    }

private:
    struct Image {
        Array2<float> truth;
        FrameScores scores;
    };

    void compare_with_blends(const Array2<float>& next_edge) {
        std::map<std::int64_t, FrameScores> blends;
        for (const auto& [offset_us, image] : images_) {
            const float share = float(offset_us) / float(phases_.window_us);
            blends[offset_us] = judge_.judge(blend_of(edge_, next_edge, share), {}, image.truth);
        }
        phases_.for_each([&](int j, int n) {
            const std::int64_t offset_us = phases_.offset_us(j, n);
            found_[{"model", n}].push_back(images_.at(offset_us).scores);
            found_[{"blend of edges", n}].push_back(blends.at(offset_us));
        });
        images_.clear();
    }

    const Phases& phases_;
    Judge judge_;
    FigureScores& found_;
    Array2<float> edge_;
    std::map<std::int64_t, Image> images_;  // by us after the window's begin
};

}  // namespace

std::vector<Plot> temporal_super_resolution(const FigureSettings& what,
                                            const EvaluateSettings& how) {
    const FigureSequences sequences{"temporal", what, how};
    const Phases phases{what.simulated.frame_width.count(), what.phases_max};
    const std::set<std::int64_t> offsets_us = phases.offsets_us();
    const FigureScores scores = sequences.run_each([&](int i, FigureScores& found) {
        BetweenEdges judged{phases, sequences.make_judge(), found};
        ModelRun run = sequences.make_run(
            [&](const Query& query, const Frame& frame) { judged.use(query, frame); });
        int k = 0;
        sequences.push_windows(
            i, run, [&](const EventWindow& event_window, const SimulatedStream& stream) {
                const Window& window = event_window.window;
                if (k > 0 && is_scored(what.simulated, k))
                    for (const std::int64_t offset : offsets_us)
                        run.ask(truth_query(stream, window.begin + SensorDuration{offset},
                                            sequences.width(), sequences.height()));
                if (!is_scored(what.simulated, ++k)) return;
                Query last_edge;
                last_edge.t = window.end;
                run.ask(std::move(last_edge));
            });
        run.finish();
    });
    return sequences.plots_of(scores,
                              {"temporal", "temporal super-resolution", "frames per event window"});
}

}  // namespace eventide
