// A folder of states.
#include "apps/cli/run/state/state_folder.h"

#include "src/binning/flicker_pairs.h"
#include "src/binning/noise_filter.h"
#include "src/core/duration_text.h"
#include "src/core/error.h"

#include <cstdio>
#include <vector>

namespace eventide::app {
namespace {

bool is_stream_state(const std::filesystem::path& file) {
    try {
        return read_safetensors(file).metadata.contains("stream.window");
    } catch (const Error&) {
        return false;
    }
}

/// Those of an earlier run. Throws Error (usage) for a file that has the name of one and is none.
std::vector<std::filesystem::path> earlier_states(const std::string& folder) {
    std::vector<std::filesystem::path> states;
    std::error_code none;
    for (std::size_t n = 0; std::filesystem::exists(state_file(folder, n), none); ++n) {
        states.push_back(state_file(folder, n));
        if (!is_stream_state(states.back()))
            throw Error(ErrorKind::usage, "--states-out " + folder +
                                              ": expected no files but an earlier run's states, "
                                              "found " +
                                              states.back().string());
    }
    return states;
}

}  // namespace

std::filesystem::path state_file(const std::string& folder, std::size_t number) {
    char name[48];
    std::snprintf(name, sizeof name, "state_%06zu.safetensors", number);
    return std::filesystem::path{folder} / name;
}

StateFolder::StateFolder(const std::string& folder, bool overwrite)
    : folder_{folder}, overwrite_{overwrite} {
    lock_.take(folder_);
    if (overwrite_) earlier_states(folder_);  // or a refusal
}

void StateFolder::keep(const TensorFile& state) {
    if (kept_ == 0 && overwrite_)
        for (const auto& earlier : earlier_states(folder_)) std::filesystem::remove(earlier);
    write_safetensors(state_file(folder_, kept_++), state, overwrite_);
}

std::string noise_filter_of(const RunSettings& settings, const ModelConfig& model) {
    const auto noise = parse_noise_filter(settings.noise_filter, model.noise_filter);
    return noise ? noise_filter_text(*noise) : "off";
}

std::string lamp_flicker_of(const RunSettings& settings, bool can_wait) {
    const auto longest = parse_lamp_flicker(settings.lamp_flicker, can_wait);
    if (!longest) return "off";
    return longest->count() > 0 ? duration_text(*longest) : "auto";
}

void check_stream_state(const RunSettings& settings, const std::string& option, bool live) {
    const auto refuse = [&option](const std::string& expected) {
        throw Error(ErrorKind::usage, option + ": expected " + expected);
    };
    if (live || is_read_once(settings.source))
        refuse("a recording that is a file, found " + settings.source);
    if (settings.frames != CameraFrames::ignore)
        refuse("--frames ignore; what the camera's images corrected is not kept");
    if (settings.colour) refuse("frames without --colour");
    if (settings.adjust.auto_hdr)
        refuse("frames without --auto-hdr; the range of those before is not kept");
    if (!settings.filter.empty())
        refuse("no --filter, found '" + settings.filter.front() +
               "'; a state keeps nothing of filters that --filter names");
    if (settings.hot_pixels == "learn") refuse("another --hot-pixels than learn");
}

}  // namespace eventide::app
