// The command line as a whole: arguments in, exit code out.
#pragma once

#include "src/app/command.h"

#include <memory>
#include <string>
#include <vector>

namespace eventide::app {

std::vector<std::unique_ptr<Command>> all_commands();

/// The configuration that is in force when nobody says anything, as a commented TOML file: what
/// config/default.toml holds.
std::string default_config();

/// Everything but main(): parses, resolves the configuration, runs the command, turns errors into
/// messages and exit codes.
int run_program(Signals& signals, std::vector<std::string> arguments);

}  // namespace eventide::app
