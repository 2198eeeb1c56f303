// The EVREAL protocol (Ercan et al. 2023; docs/accuracy.md, "Protocols").
#include "apps/evaluate/evaluate_recordings.h"
#include "apps/evaluate/evreal_sequence.h"
#include "apps/evaluate/seconds.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

namespace eventide {
namespace {

namespace fs = std::filesystem;

struct Cut {
    std::string_view sequence;
    double from_s, to_s;
};

// Seconds from the recording's first event or image; sequences not named here count in full.
constexpr Cut kCuts[] = {
    {"boxes_6dof", 5, 20},      {"calibration", 5, 20},       {"dynamic_6dof", 5, 20},
    {"poster_6dof", 5, 20},     {"shapes_6dof", 5, 20},       {"office_zigzag", 5, 12},
    {"slider_depth", 1, 2.5},   {"indoor_flying1", 10, 70},   {"indoor_flying2", 10, 70},
    {"indoor_flying3", 10, 70}, {"indoor_flying4", 10, 19.8}, {"outdoor_day1", 0, 60},
    {"outdoor_day2", 100, 160},
};
constexpr double kWarmUpSeconds = 10;

/// By the sequence's name; MVSEC's files are called NAME_data.hdf5.
const Cut* cut_of(std::string_view sequence) {
    if (sequence.ends_with("_data")) sequence.remove_suffix(5);
    const auto found = std::ranges::find(kCuts, sequence, &Cut::sequence);
    return found == std::end(kCuts) ? nullptr : found;
}

/// What a sequence that is shorter than its cut was scored on; empty where it is not.
std::string shorter_than_cut(const Cut& cut, const SequenceReport& scored) {
    constexpr double kImageSeconds = .5;  // no image need lie at the very end
    const double last_s = scored.frames.empty() ? 0 : scored.frames.back().time_s;
    if (last_s >= cut.to_s - kImageSeconds) return {};
    char text[128];
    if (scored.frames.empty())
        std::snprintf(text, sizeof text, "none of its images lies in the cut, %g to %g s",
                      cut.from_s, cut.to_s);
    else
        std::snprintf(text, sizeof text,
                      "its images end at %.1f s, before the cut of EVREAL's tables, %g to %g s",
                      last_s, cut.from_s, cut.to_s);
    return std::string{cut.sequence} + ": " + text;
}

}  // namespace

EvaluateReport evaluate_evreal(const fs::path& dataset, const EvaluateSettings& how) {
    Evaluation evaluation{"EVREAL protocol", how};
    const std::vector<fs::path> sequences = evreal_sequences(dataset);
    evaluation.run_sequences(int(sequences.size()), [&](int i) {
        const fs::path& path = sequences[std::size_t(i)];
        const Cut* cut = cut_of(sequence_name(path));
        std::optional<double> from, to;
        if (cut) {
            from = std::max(0., cut->from_s - kWarmUpSeconds);
            to = cut->to_s;
        }
        ReferenceSequence sequence = read_evreal_sequence(path, from, to);
        ScoredImages which;
        // EVREAL's loader never takes a recording's last image.
        if (!cut && sequence.images.size() > 1) which.to = sequence.images.rbegin()[1].t;
        if (cut) which.from = sequence.first + duration_from_seconds(cut->from_s);
        SequenceResult result =
            evaluate_sequence(evaluation, std::move(sequence), "reference", which);
        if (std::string note = cut ? shorter_than_cut(*cut, result.report) : ""; !note.empty())
            result.notes.push_back(std::move(note));
        return result;
    });
    if (evaluation.lpips() && evaluation.lpips()->name() != "LPIPS-Alex")
        evaluation.note("EVREAL's tables are in LPIPS-Alex: these LPIPS numbers are " +
                        evaluation.lpips()->name() + " and must not be compared with them");
    if (how.lookahead > 0)
        evaluation.note("EVREAL's tables are without lookahead: these numbers saw " +
                        std::to_string(how.lookahead) + " event windows more");
    return evaluation.finish("windows between reference images, no stretch, lamp flicker " +
                             how.lamp_flicker);
}

}  // namespace eventide
