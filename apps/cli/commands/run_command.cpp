// eventide run: what it is called with.
#include "apps/cli/commands/run_command.h"

#include "apps/cli/run/idle_flags.h"
#include "apps/cli/run/run.h"
#include "apps/cli/run/run_files.h"
#include "src/core/error.h"

#include <spdlog/spdlog.h>

#include <optional>

namespace eventide::app {

std::string RunCommand::examples() const {
    return "SOURCE is a recording, a folder of the Event Camera Dataset, davis:[SERIAL], "
           "dvxplorer:[SERIAL], dvs128:[SERIAL], v4l2:/dev/videoN, ros2:/TOPIC, udp://HOST:PORT, "
           "sim:SCENE, or - for a recording on standard input.\n"
           "Examples:\n"
           "  eventide run recording.aedat4 --out video.mp4\n"
           "  eventide run recording.raw --fps 1000 --size 2.5x --out frames/ --out video.mp4 "
           "--uncertainty side\n"
           "  eventide run recording.aedat4 --slow 8 --out - | ffmpeg -i - slow.mp4\n"
           "  eventide run recording.aedat4 --from 2s --duration 500ms --out cut/\n"
           "  eventide run davis: --out window --record raw.aedat4\n"
           "  zcat events.txt.gz | eventide run - --input-size 240x180 --out frames/";
}

std::vector<Positional> RunCommand::positionals() {
    return {{"SOURCE", "Recording, camera, or - for standard input", &settings_.source}};
}

int RunCommand::run(Program& program) {
    if (!settings_.states_out.empty()) settings_.sequential = true;
    if (settings_.out.empty() && settings_.states_out.empty())
        throw Error(ErrorKind::usage,
                    "expected at least one --out, such as --out video.mp4 or --out window");
    name_run_files(settings_, program.files);
    refuse_idle_flags(settings_, program.flags);
    std::optional<Run> run;
    try {
        run.emplace(program, settings_);
    } catch (const Error& error) {
        // A source that said nothing yet is no failure of a service that is stopped.
        if (error.kind() != ErrorKind::failed || !program.signals.stopping()) throw;
        spdlog::info("{}", error.what());
        return exit_done;
    }
    return run->run();
}

}  // namespace eventide::app
