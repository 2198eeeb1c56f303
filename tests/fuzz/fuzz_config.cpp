// Any bytes as a configuration: refused with an Error, or read, and what --print-config makes of it
// means the same.
#include "apps/cli/commands/run_command.h"
#include "apps/cli/settings/config.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

#include <sstream>

namespace {

using namespace eventide;
using namespace eventide::app;

std::string printed(const MemoryFile& file) {
    const ConfigFile config = read_config_file(file.path());
    RunCommand command;
    SettingTable table = command.settings();
    resolve_settings(table, config, {});
    for (Setting& setting : table.settings) setting.origin.clear();
    std::ostringstream text;
    print_config(text, {&table}, false);
    return text.str();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static MemoryFile file;
    file.hold(data, size);
    std::string first;
    try {
        first = printed(file);
    } catch (const Error&) {
        return 0;
    }
    file.hold(first);
    if (printed(file) != first) std::abort();
    return 0;
}
