// Real recordings: the model's picture at each reference image's time against that image.
#include "src/evaluate/evaluate_recordings.h"

#include "src/core/error.h"

#include <algorithm>

namespace eventide {
namespace {

// With a cut, inference starts this much before it (EVREAL).
constexpr double kWarmUpSeconds = 10;

/// The images as queries: the part of the sensor each covers, at its time.
std::vector<Query> queries_of(const ReferenceSequence& sequence, const ScoredImages& which) {
    std::vector<Query> queries;
    for (std::size_t i = 0; i < sequence.images.size(); ++i) {
        const ReferenceImage& image = sequence.images[i];
        Query query;
        query.t = image.t;
        query.scored = int(i) >= which.skip && image.t >= which.from && image.t <= which.to;
        if (query.scored) {
            query.truth = intensity_of(image);
            query.region = {image.x0, image.y0, query.truth.width(), query.truth.height()};
            if (image.x0 < 0 || image.y0 < 0 || image.x0 + query.region.width > sequence.width ||
                image.y0 + query.region.height > sequence.height)
                throw Error(ErrorKind::input, sequence.name + ": image " + std::to_string(i) +
                                                  " of " + std::to_string(query.region.width) +
                                                  "x" + std::to_string(query.region.height) +
                                                  " does not lie inside the sensor of " +
                                                  std::to_string(sequence.width) + "x" +
                                                  std::to_string(sequence.height));
        }
        queries.push_back(std::move(query));
    }
    return queries;
}

}  // namespace

SequenceResult evaluate_sequence(const Evaluation& evaluation, const ReferenceSequence& sequence,
                                 const std::string& window, const ScoredImages& which) {
    std::vector<Query> queries = queries_of(sequence, which);
    const auto scored = std::ranges::count_if(queries, &Query::scored);
    SequenceEvaluation judged{
        evaluation, {sequence.name, sequence.width, sequence.height, sequence.first, int(scored)}};
    for (Query& query : queries)
        if (query.scored) judged.run().ask(std::move(query));
    const auto push = [&judged](const Slice& slice) { judged.run().push(slice); };
    if (window == "reference")
        for_each_reference_slice(sequence, push);
    else
        for_each_window_slice(sequence, window, push);
    return judged.finish();
}

EvaluateReport evaluate_recordings(const RecordingSettings& what, const EvaluateSettings& how) {
    if (what.recordings.empty())
        throw Error(ErrorKind::usage, "evaluate: expected at least one recording, found none");
    Evaluation evaluation{"recordings", how};
    evaluation.run_sequences(int(what.recordings.size()), [&](int i) {
        const std::filesystem::path& path = what.recordings[std::size_t(i)];
        std::optional<double> read_from;
        if (what.from_s) read_from = std::max(0., *what.from_s - kWarmUpSeconds);
        const ReferenceSequence sequence = read_reference_sequence(path, read_from, what.to_s);
        ScoredImages which;
        const int images = int(sequence.images.size());
        which.skip = what.skip_images == RecordingSettings::kSkipHalf
                         ? images / 2
                         : std::min(what.skip_images, images - 1);
        if (what.from_s)
            which.from = sequence.first + SensorDuration{std::int64_t(*what.from_s * 1e6)};
        return evaluate_sequence(evaluation, sequence, what.window, which);
    });
    return evaluation.finish("windows " + what.window + ", first " +
                             (what.skip_images == RecordingSettings::kSkipHalf
                                  ? std::string{"half of the images"}
                                  : std::to_string(what.skip_images) + " images") +
                             " not scored");
}

}  // namespace eventide
