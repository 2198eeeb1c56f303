// Any lines as arguments: refused with an Error, answered, or a command with its settings.
#include "apps/cli/command_line.h"
#include "apps/cli/settings/config.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

#include <iostream>

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    std::cout.rdbuf(nullptr);  // help is long
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    using namespace eventide::app;
    std::vector<std::string> arguments;
    for (std::string_view rest = text_of_input(data, size); !rest.empty();)
        arguments.emplace_back(take_until(rest, '\n'));
    bool quiet = false;
    try {
        const SettingTable common{"", "", {flag_setting("quiet", quiet, "")}};
        const Parsed parsed = parse_command_line(arguments, common);
        if (!parsed.invocation || !parsed.invocation->command) return 0;
        SettingTable own = parsed.invocation->command->settings();
        resolve_settings(own, {}, parsed.invocation->command_flags);
    } catch (const Error&) {
    }
    return 0;
}
