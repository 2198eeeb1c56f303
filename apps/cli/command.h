// What every subcommand is: a name, its settings, and what it does.
#pragma once

#include "apps/cli/signals.h"
#include "src/io/named_files.h"
#include "src/settings/setting.h"

#include <set>
#include <string>
#include <vector>

namespace eventide::app {

/// Exit codes beyond those of ErrorKind.
enum ExitCode { exit_done = 0, exit_data_lost = 5 };

/// Keys of settings.
using FlagKeys = std::set<std::string>;

/// What the program knows and commands need.
struct Program {
    Signals& signals;
    std::vector<std::string> arguments;  ///< as typed, without the program's name
    bool quiet = false;
    FlagKeys flags{};    ///< of the command's settings, those that flags say
    NamedFiles files{};  ///< the configuration, and what the command adds
};

/// An argument without a flag.
struct Positional {
    std::string name, help;
    std::string* value = nullptr;                ///< either one value, which must be given ...
    std::vector<std::string>* values = nullptr;  ///< ... or any number
};

class Command {
public:
    virtual ~Command() = default;
    virtual std::string name() const = 0;
    virtual std::string summary() const = 0;
    /// Shown under --help.
    virtual std::string examples() const = 0;
    virtual std::vector<Positional> positionals() { return {}; }
    virtual SettingTable settings() = 0;

    /// Returns an exit code. Throws Error. Data go to standard output, messages to standard error.
    virtual int run(Program& program) = 0;
};

}  // namespace eventide::app
