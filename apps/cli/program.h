// The command line as a whole: arguments in, exit code out.
#pragma once

#include "apps/cli/command.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide::app {

std::vector<std::unique_ptr<Command>> all_commands();

/// The configuration that is in force when nobody says anything, as a commented TOML file: what
/// config/default.toml holds.
std::string default_config();

/// eventide(1), and the shells' completion of it: what is installed beside the program.
std::string manual_page();
std::string bash_completion();
std::string zsh_completion();
std::string fish_completion();

inline constexpr const char* kExitCodes =
    "0 done, 1 failed while running, 2 wrong usage or configuration, 3 input unreadable, 4 device "
    "missing or lost, 5 finished but data were lost (with --strict), 130 and 143 cut short by a "
    "second SIGINT or SIGTERM.";

/// Everything but main(): parses, resolves the configuration, runs the command, turns errors into
/// messages and exit codes.
int run_program(Signals& signals, std::vector<std::string> arguments);

}  // namespace eventide::app
