// A folder of states, of --states-out: what is in it, and which runs have such states.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "src/model/model_config.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace eventide::app {

/// FOLDER/state_000002.safetensors
std::filesystem::path state_file(const std::string& folder, std::size_t number);

/// Those of an earlier run in a folder that may not exist. Throws Error (usage) for a file that has
/// the name of one and is none.
std::vector<std::filesystem::path> earlier_states(const std::string& folder);

/// noise_filter_text() of what a run has, or "off".
std::string noise_filter_of(const RunSettings& settings, const ModelConfig& model);

/// How long events wait for the second of a pair ("16ms"; "auto": three quarters of a period), or
/// "off".
std::string lamp_flicker_of(const RunSettings& settings, bool can_wait);

/// Throws Error (usage) naming the option, where a run has more to remember than is kept: images of
/// the camera, colours, filters of the user's.
void check_stream_state(const RunSettings& settings, const std::string& option, bool live);

}  // namespace eventide::app
