// The EVREAL protocol (Ercan et al. 2023; docs/accuracy.md, "Protocols").
#include "apps/evaluate/evaluate_recordings.h"
#include "apps/evaluate/evreal_sequence.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>

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

std::string none_in_cut(const Cut& cut, std::size_t images) {
    char seconds[64];
    std::snprintf(seconds, sizeof seconds, "%g to %g s", cut.from_s, cut.to_s);
    return std::string{cut.sequence} + ": none of its " + counted(images, "image") +
           " lies in the cut, " + seconds;
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
        if (cut) which.from = sequence.first + SensorDuration{std::int64_t(cut->from_s * 1e6)};
        const std::size_t images = sequence.images.size();
        SequenceResult result =
            evaluate_sequence(evaluation, std::move(sequence), "reference", which);
        if (cut && result.report.frames.empty()) result.notes.push_back(none_in_cut(*cut, images));
        return result;
    });
    if (evaluation.lpips() && evaluation.lpips()->name() != "LPIPS-Alex")
        evaluation.note("EVREAL's tables are in LPIPS-Alex: these LPIPS numbers are " +
                        evaluation.lpips()->name() + " and must not be compared with them");
    if (how.lookahead > 0)
        evaluation.note("EVREAL's tables are without lookahead: these numbers saw " +
                        std::to_string(how.lookahead) + " event windows more");
    return evaluation.finish("windows between reference images, no stretch");
}

}  // namespace eventide
