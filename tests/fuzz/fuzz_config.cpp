// Any bytes as a configuration: refused with an Error, or read, and what --print-config makes of it
// means the same.
#include "apps/cli/settings/config.h"
#include "apps/cli/settings/run_settings.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

#include <optional>
#include <sstream>

namespace {

using namespace eventide;
using namespace eventide::app;

/// Settings as they are before anybody says anything, under one table of them: to make 180 settings
/// takes longer than to read most inputs.
struct Settings {
    Settings() { table = values.emplace().table(); }
    /// At the same place, to which the table points.
    void reset() { values.emplace(); }

    std::optional<RunSettings> values;
    SettingTable table;
};

std::string printed(const MemoryFile& file) {
    static Settings settings;
    const ConfigFile config = read_config_file(file.path());
    settings.reset();
    SettingTable& table = settings.table;
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
