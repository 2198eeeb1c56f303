// Simulation: the model's images against what an ideal camera would have shown.
#include "apps/evaluate/evaluation.h"
#include "apps/evaluate/simulated_sequence.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/simulate/presets.h"
#include "src/simulate/scene/textures_folder.h"

#include <cmath>

namespace eventide {

void check_simulated(const SimulatedSettings& what) {
    const auto need = [](bool holds, const std::string& text) {
        if (!holds) throw Error(ErrorKind::usage, "simulated test set: expected " + text);
    };
    need(what.sequences >= 1 && what.event_windows >= 1, "at least one sequence and event window");
    need(what.width >= 16 && what.height >= 16, "a sensor of at least 16x16");
    need(what.scale >= 1 && what.scale <= 8, "a scale of 1 to 8");
    need(what.score_every >= 1 && what.skip_frames >= 0, "to score one frame in 1 or more");
    need(what.event_windows >= what.skip_frames + what.score_every,
         "at least " + std::to_string(what.skip_frames + what.score_every) +
             " event windows, of which the last is scored, found " +
             std::to_string(what.event_windows));
    need(what.frame_width.count() >= 1000, "event windows of at least 1 ms");
    for (const double phase : what.phases)
        need(phase > 0 && phase <= 1, "times within the event window, more than 0 and at most 1");
}

bool is_scored(const SimulatedSettings& what, int k) {
    return k >= what.skip_frames && (k - what.skip_frames + 1) % what.score_every == 0;
}

std::shared_ptr<const TextureLibrary> test_textures(const SimulatedSettings& what) {
    if (what.images.empty()) return procedural_textures(24, 256, what.seed);
    std::vector<std::filesystem::path> files = image_files(what.images);
    const auto wanted = std::size_t(what.last_images);
    if (wanted > 0 && files.size() > wanted)
        files.erase(files.begin(), files.end() - std::ptrdiff_t(wanted));
    auto textures = std::make_shared<TextureLibrary>();
    for (const std::filesystem::path& file : files) textures->add(read_grey_image(file));
    return textures;
}

void for_each_simulated_window(
    const SimulatedSettings& what, const std::shared_ptr<const TextureLibrary>& textures, int i,
    std::optional<NoiseFilterSettings> noise_filter,
    const std::function<bool(const EventWindow&, const SimulatedStream&)>& use) {
    const SimulationPreset& preset = simulation_preset(what.preset);
    SimulatedStream stream{preset.scene, preset.sensor, textures,
                           what.width,   what.height,   what.seed + std::uint64_t(i)};
    std::optional<NoiseFilter> filter;
    if (noise_filter) filter.emplace(what.width, what.height, *noise_filter);
    const SensorTime begin = stream.now();
    std::vector<Event> events;
    for (int k = 0; k < what.event_windows; ++k) {
        const Window window{begin + k * what.frame_width, begin + (k + 1) * what.frame_width};
        events.clear();
        stream.advance(window.end, events);
        if (filter) filter->process(events);
        if (!use({.window = window, .events = events}, stream)) return;
    }
}

Query truth_query(const SimulatedStream& stream, SensorTime t, int width, int height) {
    Query query;
    query.t = t;
    query.width = width;
    query.height = height;
    query.truth = Array2<float>(height, width);
    stream.truth(t, query.truth);
    return query;
}

EvaluateReport evaluate_simulated(const SimulatedSettings& what, const EvaluateSettings& how) {
    check_simulated(what);
    Evaluation evaluation{"simulated '" + what.preset + "'", how};
    const auto textures = test_textures(what);
    const int width = int(std::lround(what.width * what.scale));
    const int height = int(std::lround(what.height * what.scale));
    int scored = 0;
    for (int k = 0; k < what.event_windows; ++k) scored += is_scored(what, k) ? 1 : 0;
    evaluation.run_sequences(what.sequences, [&](int i) {
        SequenceEvaluation judged{
            evaluation,
            {"seed " + std::to_string(what.seed + std::uint64_t(i)), what.width, what.height,
             SensorTime{}, scored * int(what.phases.size())}};
        int k = 0;
        for_each_simulated_window(
            what, textures, i, evaluation.noise_filter(),
            [&](const EventWindow& event_window, const SimulatedStream& stream) {
                if (is_scored(what, k++))
                    for (const double phase : what.phases)
                        judged.run().ask(truth_query(
                            stream,
                            event_window.window.begin +
                                SensorDuration{std::llround(
                                    phase * double(event_window.window.width().count()))},
                            width, height));
                judged.run().push(event_window);
                return true;
            });
        return judged.finish();
    });
    return evaluation.finish(counted(std::uint64_t(what.sequences), "sequence") + " of " +
                             counted(std::uint64_t(what.event_windows), "event window") +
                             ", one in " + std::to_string(what.score_every) + " scored, " +
                             std::to_string(what.width) + "x" + std::to_string(what.height) +
                             ", frames " + std::to_string(width) + "x" + std::to_string(height));
}

}  // namespace eventide
