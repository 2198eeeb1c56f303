// Arguments into a command and the values of its flags.
#pragma once

#include "apps/cli/command.h"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide::app {

/// What the flags say, by key.
using FlagValues = std::map<std::string, std::vector<std::string>>;

/// The command line, once it is understood.
struct Invocation {
    std::unique_ptr<Command> command;  ///< null with print_config alone
    FlagValues command_flags, common_flags;
    std::string config_file;
    bool print_config = false;
};

struct Parsed {
    std::optional<Invocation> invocation;  ///< empty: `exit_code` says it all
    int exit_code = 0;
};

/// Prints what --help, --version and --default-config ask for. Throws Error (usage) that names what
/// was not understood and, where one is close, what may have been meant.
Parsed parse_command_line(const std::vector<std::string>& arguments, const SettingTable& common);

/// Where to read on, for the ends of messages: "; see eventide run --help".
std::string help_hint(const std::string& command = "");

}  // namespace eventide::app
