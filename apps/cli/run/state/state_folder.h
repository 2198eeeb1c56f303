// A folder of states, of --states-out: what is in it, and which runs have such states.
#pragma once

#include "apps/cli/settings/run_settings.h"
#include "src/io/file_lock.h"
#include "src/model/model_config.h"
#include "src/nn/safetensors.h"

#include <cstddef>
#include <filesystem>
#include <string>

namespace eventide::app {

/// FOLDER/state_000002.safetensors
std::filesystem::path state_file(const std::string& folder, std::size_t number);

/// The folder while a run keeps its states there.
class StateFolder {
public:
    /// Makes the folder, and keeps other runs out of it. Throws Error (usage) where, with
    /// `overwrite`, a file that has the name of a state is none.
    StateFolder(const std::string& folder, bool overwrite);

    /// As the next file. An earlier run's states stay until there is one of this.
    void keep(const TensorFile& state);
    std::size_t kept() const { return kept_; }

private:
    std::string folder_;
    bool overwrite_;
    FolderLock lock_;
    std::size_t kept_ = 0;
};

/// noise_filter_text() of what a run has, or "off".
std::string noise_filter_of(const RunSettings& settings, const ModelConfig& model);

/// How long events wait for the second of a pair ("16ms"; "auto": three quarters of a period), or
/// "off".
std::string lamp_flicker_of(const RunSettings& settings, bool can_wait);

/// Throws Error (usage) naming the option, where a run has more to remember than is kept: images of
/// the camera, colours, filters of the user's.
void check_stream_state(const RunSettings& settings, const std::string& option, bool live);

}  // namespace eventide::app
