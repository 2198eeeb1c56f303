// Every file that eventide run was told to read or to write.
#include "apps/cli/run/run_files.h"

#include "apps/cli/commands/command_files.h"
#include "apps/cli/settings/model_path.h"
#include "apps/cli/settings/sink_name.h"
#include "drivers/devices.h"
#include "drivers/simulated/simulated_name.h"

namespace eventide::app {

void name_run_files(const RunSettings& settings, NamedFiles& files) {
    files.may_replace(settings.overwrite);
    if (!names_simulation(settings.source) && !names_camera(settings.source))
        name_recording("SOURCE", settings.source, files);
    files.reads("--camera", settings.camera);
    if (settings.hot_pixels != "off" && settings.hot_pixels != "learn")
        files.reads("--hot-pixels", settings.hot_pixels);
    files.reads("--model", found_model(settings.model));
    files.reads("--state-in", settings.state_in);

    name_sink_files(settings, files);
    files.writes("--record", settings.record);
    if (settings.stats != "-") files.writes("--stats", settings.stats);
    files.writes("--state-out", settings.state_out);
}

}  // namespace eventide::app
