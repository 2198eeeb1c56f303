// The simulated test set: event windows and their ground truth, sequence by sequence.
#pragma once

#include "apps/evaluate/evaluate.h"
#include "apps/evaluate/model_run.h"
#include "src/binning/noise_filter.h"
#include "src/core/frame_data.h"
#include "src/simulate/scene/textures.h"
#include "src/simulate/simulated_stream.h"

#include <functional>
#include <memory>
#include <optional>

namespace eventide {

/// Throws Error (usage) for settings that give no sequences, or none that is scored.
void check_simulated(const SimulatedSettings& what);

/// The textures the settings name. Throws Error.
std::shared_ptr<const TextureLibrary> test_textures(const SimulatedSettings& what);

/// Whether event window k, from 0, is one of those that count.
bool is_scored(const SimulatedSettings& what, int k);

/// Sequence `i`: calls use(event window, stream) after each event window, when the truth of any
/// time within it can be asked of the stream. Ends early where `use` returns false. `noise_filter`:
/// none: all events are taken.
void for_each_simulated_window(
    const SimulatedSettings& what, const std::shared_ptr<const TextureLibrary>& textures, int i,
    std::optional<NoiseFilterSettings> noise_filter,
    const std::function<bool(const EventWindow&, const SimulatedStream&)>& use);

/// The truth at t as an image of width x height px, as a query.
Query truth_query(const SimulatedStream& stream, SensorTime t, int width, int height);

}  // namespace eventide
