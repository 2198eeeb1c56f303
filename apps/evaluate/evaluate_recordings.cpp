// Real recordings: the model's image at each reference image's time against that image.
#include "apps/evaluate/evaluate_recordings.h"

#include "apps/evaluate/seconds.h"
#include "pipeline/filters/event_filter.h"
#include "src/core/damage_text.h"
#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

namespace eventide {
namespace {

// With a cut, inference starts this much before it (EVREAL).
constexpr double kWarmUpSeconds = 10;

/// Image `i` as a query: the part of the sensor it covers, at its time.
Query query_of(const ReferenceSequence& sequence, std::size_t i) {
    const ReferenceImage& image = sequence.images[i];
    Query query;
    query.t = image.t;
    query.truth = intensity_of(image);
    query.region = {image.x0, image.y0, query.truth.width(), query.truth.height()};
    if (image.x0 < 0 || image.y0 < 0 || image.x0 + query.region.width > sequence.width ||
        image.y0 + query.region.height > sequence.height)
        throw Error(ErrorKind::input, sequence.name + ": image " + std::to_string(i) + " of " +
                                          std::to_string(query.region.width) + "x" +
                                          std::to_string(query.region.height) +
                                          " does not lie inside the sensor of " +
                                          std::to_string(sequence.width) + "x" +
                                          std::to_string(sequence.height));
    return query;
}

/// Which images count, by number, in order of time.
std::vector<std::size_t> scored_images(const ReferenceSequence& sequence,
                                       const ScoredImages& which) {
    std::vector<std::size_t> scored;
    for (auto i = std::size_t(which.skip); i < sequence.images.size(); ++i) {
        const SensorTime t = sequence.images[i].t;
        if (which.is_given(i)) continue;
        if (t >= which.from && t <= which.to) scored.push_back(i);
    }
    return scored;
}

void require_scored(const ReferenceSequence& sequence, const ScoredImages& which) {
    if (!scored_images(sequence, which).empty()) return;
    const auto seconds = [&](SensorTime t) {
        return std::to_string(std::chrono::duration<double>(t - sequence.first).count());
    };
    std::string found = counted(sequence.images.size(), "image");
    if (!sequence.images.empty())
        found += " from " + seconds(sequence.images.front().t) + " to " +
                 seconds(sequence.images.back().t) + " s, the first " + std::to_string(which.skip) +
                 " not scored (--skip)";
    throw Error(ErrorKind::usage, sequence.name +
                                      ": expected an image to score between --from and --to, "
                                      "found " +
                                      found);
}

}  // namespace

SequenceResult evaluate_sequence(const Evaluation& evaluation, ReferenceSequence sequence,
                                 const std::string& window, const ScoredImages& which) {
    if (evaluation.settings().warn)
        for (const std::string& text : sequence.warnings) evaluation.settings().warn(text);
    if (sequence.events.empty() && !sequence.images.empty())
        throw Error(ErrorKind::input,
                    sequence.name + ": expected events, found none in the time asked for");
    const std::unique_ptr<EventFilter> filter =
        evaluation.filter_for(sequence.width, sequence.height);
    const std::vector<std::size_t> scored = scored_images(sequence, which);
    SequenceEvaluation judged{
        evaluation,
        {sequence.name, sequence.width, sequence.height, sequence.first, int(scored.size())}};
    // Asked for one event window at a time, so that a long recording's truth is not all in memory.
    auto next = scored.begin();
    std::size_t given = 0;
    const auto give_until = [&](SensorTime end) {
        for (; given < sequence.images.size() && sequence.images[given].t <= end; ++given)
            if (which.is_given(given)) judged.run().give(sequence.images[given]);
    };
    const auto ask_until = [&](SensorTime end) {
        for (; next != scored.end() && sequence.images[*next].t <= end; ++next)
            judged.run().ask(query_of(sequence, *next));
    };
    const auto push = [&](const EventWindow& event_window) {
        ask_until(event_window.window.end);
        give_until(event_window.window.end);
        judged.run().push(event_window);
    };
    if (window == "reference") {
        if (filter) {
            std::vector<Event> rest;
            filter->process(sequence.events);
            filter->flush(rest);
            sequence.events.insert(sequence.events.end(), rest.begin(), rest.end());
        }
        for_each_reference_window(sequence, push);
    } else {
        for_each_cut_window(sequence, window, filter.get(), push);
    }
    ask_until(SensorTime::max());
    SequenceResult result = judged.finish();
    if (const std::string remark = filter ? flicker_remark(filter->flicker()) : ""; !remark.empty())
        result.notes.push_back(sequence.name + ": " + remark);
    if (sequence.damaged.total() > 0)
        result.notes.push_back(sequence.name + ": left out of the recording, as it is damaged: " +
                               damage_text(sequence.damaged));
    return result;
}

EvaluateReport evaluate_recordings(const RecordingSettings& what, const EvaluateSettings& how) {
    if (what.recordings.empty())
        throw Error(ErrorKind::usage, "evaluate: expected at least one recording, found none");
    if (what.from_s && what.to_s && *what.from_s >= *what.to_s)
        throw Error(ErrorKind::usage, "--to: expected a time after --from (" +
                                          std::to_string(*what.from_s) + " s), found " +
                                          std::to_string(*what.to_s) + " s");
    EvaluateSettings settings = how;
    settings.fuse_images = what.given_images > 0;
    Evaluation evaluation{"recordings", settings};
    const std::string window =
        what.window == "model" ? evaluation.model().config.window : what.window;
    evaluation.run_sequences(int(what.recordings.size()), [&](int i) {
        const std::filesystem::path& path = what.recordings[std::size_t(i)];
        std::optional<double> read_from;
        if (what.from_s) read_from = std::max(0., *what.from_s - kWarmUpSeconds);
        ReferenceSequence sequence =
            read_reference_sequence(path, read_from, what.to_s, what.input, what.bayer);
        ScoredImages which;
        which.given = what.given_images;
        const int images = int(sequence.images.size());
        which.skip = what.skip_images == RecordingSettings::kSkipHalf
                         ? images / 2
                         : std::max(0, std::min(what.skip_images, images - 1));
        if (what.from_s) which.from = sequence.first + duration_from_seconds(*what.from_s);
        require_scored(sequence, which);
        const std::string name = sequence.name;
        SequenceResult result = evaluate_sequence(evaluation, std::move(sequence), window, which);
        if (which.skip < what.skip_images)
            result.notes.push_back(name + ": of " + counted(std::uint64_t(images), "image") +
                                   " the first " + std::to_string(which.skip) + " are not scored");
        return result;
    });
    return evaluation.finish("windows " + window + ", first " +
                             (what.skip_images == RecordingSettings::kSkipHalf
                                  ? std::string{"half of the images"}
                                  : counted(std::uint64_t(what.skip_images), "image")) +
                             " not scored" +
                             (what.given_images > 0
                                  ? ", one image of " + std::to_string(what.given_images) + " given"
                                  : std::string{}) +
                             ", lamp flicker " + how.lamp_flicker);
}

}  // namespace eventide
