// davis-emulator RECORDING -- COMMAND...: runs a command that sees a DAVIS on USB, which sees the
// recording.
//
// Any program that uses libusb will do. The camera starts when the program starts it, plays the
// recording once in real time, and then goes on in silence, as a camera before a wall.
#include "replay/formats.h"
#include "src/core/error.h"
#include "tests/support/preload.h"
#include "tests/support/usb/davis_model.h"
#include "tests/support/usb/recorded_scene.h"
#include "tests/support/usb/usb_testbed.h"

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>

namespace eventide {
namespace {

using testing_support::DavisModel;
using testing_support::DavisModelSettings;
using testing_support::scene_of;
using testing_support::sensor_for;
using testing_support::UsbTestbed;

struct Arguments {
    std::string recording;
    bool fast = false;  ///< as fast as the program reads instead of real time
    char** command = nullptr;
};

constexpr const char* kUsage =
    "usage: davis-emulator [--fast] RECORDING -- COMMAND...\n"
    "Runs COMMAND, which sees a DAVIS on USB that sees RECORDING (any format eventide reads, "
    "240x180 or up to 346x260).\n"
    "  --fast   data come as fast as they are fetched, not in real time\n"
    "Example: davis-emulator flight.aedat4 -- eventide run davis: --out frames/\n";

bool parse(int argc, char** argv, Arguments& into) {
    int i = 1;
    for (; i < argc && std::strcmp(argv[i], "--") != 0; ++i) {
        if (std::strcmp(argv[i], "--fast") == 0)
            into.fast = true;
        else if (into.recording.empty() && argv[i][0] != '-')
            into.recording = argv[i];
        else
            return false;
    }
    if (i + 1 >= argc || into.recording.empty()) return false;
    into.command = argv + i + 1;
    return true;
}

SensorTime real_time() {
    return SensorTime{std::chrono::duration_cast<SensorDuration>(
        std::chrono::steady_clock::now().time_since_epoch())};
}

int run(const Arguments& arguments) {
    const auto recording = open_recording(arguments.recording);
    DavisModelSettings settings;
    settings.sensor = sensor_for(recording->info());
    if (!arguments.fast) settings.now = real_time;
    const auto camera = std::make_shared<DavisModel>(settings);
    Batch data = scene_of(*recording);
    std::fprintf(stderr,
                 "davis-emulator: a %dx%d camera, serial %s, sees %zu events and %zu images\n",
                 settings.sensor.width(), settings.sensor.height(), settings.serial.c_str(),
                 data.events.size(), data.images.size());
    camera->show(std::move(data));
    UsbTestbed bed;
    bed.plug_in(camera);

    const pid_t child = fork();
    if (child < 0) throw Error(ErrorKind::failed, "cannot start another process");
    if (child == 0) {
        execvp(arguments.command[0], arguments.command);
        std::fprintf(stderr, "davis-emulator: %s: %s\n", arguments.command[0],
                     std::strerror(errno));
        _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace
}  // namespace eventide

int main(int argc, char** argv) {
    eventide::Arguments arguments;
    if (!eventide::parse(argc, argv, arguments)) {
        std::fputs(eventide::kUsage, stderr);
        return 2;
    }
    eventide::testing_support::enter_testbed(argv);
    try {
        return eventide::run(arguments);
    } catch (const eventide::Error& error) {
        std::fprintf(stderr, "davis-emulator: %s\n", error.what());
        return int(error.kind());
    }
}
