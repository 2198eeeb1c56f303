// What a run remembers beside its networks, in the same file: with it another run gives the frames
// that this one would have given.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "pipeline/filters/event_filter.h"
#include "pipeline/pipeline_state.h"
#include "src/model/model_config.h"
#include "src/nn/safetensors.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace eventide::app {

struct StreamState {
    PipelineState stream;
    EventFilters::State filters;
    /// How events were cut and filtered: window_text(), noise_filter_of(), lamp_flicker_of().
    std::string window, noise_filter, lamp_flicker;
};

/// Adds it to the state of the network. Sensor of width px a row.
void put_stream_state(const StreamState& state, int width, TensorFile& file);

/// Takes it out of the file again; empty where there is none. Throws Error (input) naming the file
/// `name` and what differs, where it is of another sensor (width x height px) or damaged.
std::optional<StreamState> take_stream_state(TensorFile& file, const std::string& name, int width,
                                             int height);

/// FOLDER/state_000002.safetensors, of --states-out.
std::filesystem::path state_file(const std::string& folder, std::size_t number);

/// Removes an earlier run's states from a folder that may not exist. Throws Error (usage) for a
/// file that has the name of one and is none, before anything is removed.
void remove_states(const std::string& folder);

/// noise_filter_text() of what a run has, or "off".
std::string noise_filter_of(const RunSettings& settings, const ModelConfig& model);

/// How long events wait for the second of a pair ("16ms"; "auto": three quarters of a period), or
/// "off".
std::string lamp_flicker_of(const RunSettings& settings, bool can_wait);

/// Throws Error (usage) naming the option, where a run has more to remember than is kept: images of
/// the camera, colours, filters of the user's.
void check_stream_state(const RunSettings& settings, const std::string& option, bool live);

}  // namespace eventide::app
