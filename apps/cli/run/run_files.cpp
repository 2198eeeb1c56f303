// Every file that eventide run was told to read or to write.
#include "apps/cli/run/run_files.h"

#include "apps/cli/commands/command_files.h"
#include "apps/cli/commands/recording_out.h"
#include "apps/cli/run/events_out.h"
#include "apps/cli/run/quality/open_settings.h"
#include "apps/cli/run/state/state_folder.h"
#include "apps/cli/settings/model_path.h"
#include "apps/cli/settings/sink_name.h"
#include "apps/cli/terminal.h"
#include "drivers/devices.h"
#include "drivers/simulated/simulated_name.h"

namespace eventide::app {

namespace {

void name_events_out(const std::string& to, bool force, NamedFiles& files) {
    const std::string file = file_of_event_target(to);
    if (to.empty() || file.starts_with("udp://")) return;
    if (to != "-" && !to.starts_with("text:")) refuse_terminal("--events-out " + to, file, force);
    if (names_folder(file))
        name_run_folder("--events-out", file, EcdWriter::files(), files);
    else
        files.writes("--events-out", file, to);
}

void name_states_out(const RunSettings& settings, NamedFiles& files) {
    if (settings.states_out.empty()) return;
    files.writes_folder("--states-out", settings.states_out);
    // Those of an earlier run, which go, are no input of this.
    std::error_code none;
    for (std::size_t i = 0;
         i < settings.states_at.size() ||
         (settings.overwrite && std::filesystem::exists(state_file(settings.states_out, i), none));
         ++i)
        files.writes("--states-out", state_file(settings.states_out, i));
}

}  // namespace

void name_run_files(const RunSettings& settings, NamedFiles& files) {
    files.may_replace(settings.overwrite);
    if (names_simulation(settings.source))
        name_files("SOURCE", parse_simulated_name(settings.source).textures, files);
    else if (!names_camera(settings.source))
        name_recording("SOURCE", settings.source, files);
    files.reads("--camera", settings.camera);
    if (settings.hot_pixels != "off" && settings.hot_pixels != "learn")
        files.reads("--hot-pixels", settings.hot_pixels);
    files.reads("--undistort", settings.undistort);
    // Any of them may be chosen, where nothing else was said.
    for (const std::string& model : models_to_choose_from(settings))
        files.reads("--model", found_model(model));
    files.reads("--state-in", settings.state_in);

    name_filter_files(settings.filter, files);

    // Outputs in the order in which they are opened: each may lie in a folder that one before
    // makes.
    name_sink_files(settings, files);
    files.writes("--record", settings.record);
    name_events_out(settings.events_out, settings.force, files);
    name_states_out(settings, files);
    if (settings.stats != "-") files.writes("--stats", settings.stats);  // else standard error
    files.writes_when_done("--state-out", settings.state_out);
}

}  // namespace eventide::app
