// eventide run as a whole, of any bytes, with the tiniest network and sensor: every stage, frames,
// sigma. A sensor of any size is for the target recording, words of a command line for
// command_line: here every pixel and every setting costs time. One input of eight has a thread for
// each stage.
#include "apps/cli/commands/run_command.h"
#include "apps/cli/settings/config.h"
#include "apps/cli/signals.h"
#include "apps/cli/terminal.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

namespace {

using namespace eventide;
using namespace eventide::app;

std::map<std::string, std::vector<std::string>> flags(bool threads) {
    return {{"model", {EVENTIDE_FUZZ_MODEL}},
            {"input_size", {"16x12"}},
            {"out", {"gray8:/dev/null"}},
            {"overwrite", {"true"}},
            {"size", {"8x6"}},
            {"fps", {"50"}},
            {"precision", {"f32"}},
            {"duration", {"100ms"}},
            {"threads", {"1"}},
            {"sequential", {threads ? "false" : "true"}}};
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
    RunCommand command;
    SettingTable table = command.settings();
    resolve_settings(table, {}, flags(size % 8 == 0));
    *command.positionals().front().value = recording.path();
    Program program{signals, {}, true};
    try {
        command.run(program);
    } catch (const Error&) {
    }
    return 0;
}
