// A run as a whole, of any bytes, with the tiniest network and sensor: every stage, frames, sigma.
// A sensor of any size is for the target recording, words of a command line for command_line: here
// every pixel and every setting costs time, and so would a trial of the same network each time. One
// input of eight has a thread for each stage.
#include "apps/cli/run/idle_flags.h"
#include "apps/cli/run/run.h"
#include "apps/cli/run/run_files.h"
#include "apps/cli/signals.h"
#include "apps/cli/terminal.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

namespace {

using namespace eventide;
using namespace eventide::app;

void choose(RunSettings& settings, bool threads) {
    settings.model = EVENTIDE_FUZZ_MODEL;
    settings.tries_model = false;
    settings.input.size = {16, 12};
    settings.out = {"gray8:/dev/null"};
    settings.overwrite = true;
    settings.size.exact = {8, 6};
    settings.fps = {false, parse_frame_rate("50")};
    settings.precision = Precision::f32;
    settings.duration = SensorDuration{100'000};
    settings.threads = 1;
    settings.sequential = !threads;
    settings.model_given = settings.size_given = true;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    start_log({.log_level = "off", .quiet = true});
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Signals signals;
    static MemoryFile recording;
    recording.hold(data, size);
    RunSettings settings;
    choose(settings, size % 8 == 0);
    settings.source = recording.path();
    Program program{signals, {}, true};
    try {
        name_run_files(settings, program.files);
        refuse_idle_flags(settings, program.flags);
        Run{program, settings}.run();
    } catch (const Error&) {
    }
    return 0;
}
