// What a run remembers beside its networks, in the same file: with it another run gives the frames
// that this one would have given.
#pragma once

#include "pipeline/filters/event_filter.h"
#include "pipeline/pipeline_state.h"
#include "src/nn/safetensors.h"

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

}  // namespace eventide::app
