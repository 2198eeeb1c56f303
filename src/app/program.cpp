// Parses the command line, resolves the configuration, runs a command, and says what went wrong.
#include "src/app/program.h"

#include "src/app/config.h"
#include "src/app/talk.h"
#include "src/app/version.h"
#include "src/core/error.h"

#include <CLI/CLI.hpp>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <utility>

namespace eventide::app {

namespace {

/// What all commands share.
struct CommonSettings {
    TalkSettings talk;

    SettingTable table() {
        SettingTable common{"", "What all commands share.", {}};
        common.settings.push_back(parsed_setting<std::string>(
            "log_level", talk.log_level, "LEVEL",
            "What is said on standard error: trace, debug, info, warning, error or off.",
            [](const std::string& text) {
                parse_choice(text, {"trace", "debug", "info", "warning", "error", "off"});
                return text;
            },
            [](const std::string& text) { return text; }));
        common.settings.push_back(flag_setting(
            "quiet", talk.quiet, "No progress and no summaries; warnings and errors stay."));
        return common;
    }
};

using FlagValues = std::map<std::string, std::vector<std::string>>;

/// Lines of at most 78 columns beside CLI11's column of names.
std::string wrapped(const std::string& text) {
    constexpr std::size_t kWidth = 48;
    std::string lines, line;
    std::istringstream words{text};
    for (std::string word; words >> word;) {
        if (!line.empty() && line.size() + 1 + word.size() > kWidth)
            lines += std::exchange(line, "") + "\n";
        line += (line.empty() ? "" : " ") + word;
    }
    return lines + line;
}

std::string help_of(const Setting& setting) {
    const std::vector<std::string> value = setting.show();
    const bool tell = setting.kind != ValueKind::flag && !value.empty() && !value.back().empty();
    return wrapped(setting.help + (tell ? " [" + value.back() + "]" : ""));
}

/// One table's settings as options of a CLI11 command.
class Options {
public:
    void add(CLI::App& app, const SettingTable& table) {
        for (const Setting& setting : table.settings)
            if (setting.kind == ValueKind::flag)
                add_flag(app, setting);
            else
                add_option(app, setting);
    }

    FlagValues given() const {
        FlagValues values;
        for (const Entry& entry : entries_) {
            if (entry.option->count() > 0) values[entry.key] = entry.option->results();
            if (entry.opposite != nullptr && entry.opposite->count() > 0)
                values[entry.key] = {"false"};
        }
        return values;
    }

private:
    struct Entry {
        std::string key;
        CLI::Option* option = nullptr;
        CLI::Option* opposite = nullptr;  // --no-x, to overrule file and environment; not in --help
    };

    void add_flag(CLI::App& app, const Setting& setting) {
        const std::string flag = flag_of(setting);
        CLI::Option* opposite = app.add_flag("--no-" + flag.substr(2))->group("");
        const std::string help = help_of(setting);
        CLI::Option* option = app.add_flag(flag, help);
        opposite->excludes(option);
        entries_.push_back({setting.key, option, opposite});
    }

    void add_option(CLI::App& app, const Setting& setting) {
        const std::string flag = flag_of(setting);
        const std::string names =
            setting.short_flag.empty() ? flag : setting.short_flag + "," + flag;
        const std::string help = help_of(setting);
        CLI::Option* option = app.add_option(names, help);
        // One value each: `--out a/ b` must not swallow b.
        option->type_name(setting.value_name)
            ->expected(1)
            ->multi_option_policy(setting.kind == ValueKind::list
                                      ? CLI::MultiOptionPolicy::TakeAll
                                      : CLI::MultiOptionPolicy::TakeLast);
        option->allow_extra_args(false);
        entries_.push_back({setting.key, option, nullptr});
    }

    std::vector<Entry> entries_;
};

/// The command line, once it is understood.
struct Invocation {
    std::unique_ptr<Command> command;
    FlagValues command_flags, common_flags;
    std::string config_file;
    bool print_config = false;
};

struct Parsed {
    std::optional<Invocation> invocation;  ///< empty: `exit_code` says it all
    int exit_code = 0;
};

std::string hint() {
    return "; `eventide --help` and `eventide COMMAND --help` show what there is";
}

void add(CLI::App& app, const Positional& positional) {
    const std::string help = wrapped(positional.help);
    CLI::Option* option = positional.value != nullptr
                              ? app.add_option(positional.name, *positional.value, help)
                              : app.add_option(positional.name, *positional.values, help);
    option->type_name("");
}

Parsed parse(std::vector<std::string> arguments, CommonSettings& common) {
    CLI::App app{"Video with uncertainty from event cameras, in real time.", "eventide"};
    app.footer(
        "Examples:\n"
        "  eventide run recording.aedat4 --out video.mp4\n"
        "  eventide info recording.raw\n"
        "  eventide run recording.aedat4 --fps 200 --out - | ffplay -\n"
        "Exit codes: 0 done, 1 failed while running, 2 wrong usage or configuration, 3 input "
        "unreadable,\n"
        "4 device missing or lost, 5 finished but data were lost (with --strict).");
    app.set_version_flag("--version", version_text());
    app.require_subcommand(0, 1);
    app.fallthrough();
    Invocation invocation;
    bool print_defaults = false;
    app.add_option("--config", invocation.config_file, "TOML file with settings")
        ->type_name("FILE")
        ->envname("EVENTIDE_CONFIG");
    app.add_flag("--print-config", invocation.print_config,
                 wrapped("Show each value of the command and where it comes from, and end"));
    app.add_flag("--default-config", print_defaults,
                 wrapped("Print a configuration file with all keys, their meaning and defaults, "
                         "and end"));
    Options common_options;
    common_options.add(app, common.table());

    auto commands = all_commands();
    std::vector<Options> options(commands.size());
    std::vector<CLI::App*> apps;
    for (std::size_t i = 0; i < commands.size(); ++i) {
        CLI::App* sub = app.add_subcommand(commands[i]->name(), commands[i]->summary());
        sub->footer(commands[i]->examples());
        for (const Positional& positional : commands[i]->positionals()) add(*sub, positional);
        options[i].add(*sub, commands[i]->settings());
        apps.push_back(sub);
    }
    try {
        std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
        app.parse(std::move(arguments));
    } catch (const CLI::Success& success) {  // --help, --version
        app.exit(success, std::cout, std::cerr);
        return {};
    } catch (const CLI::ParseError& error) {
        throw Error(ErrorKind::usage, error.what() + hint());
    }
    if (print_defaults) {
        std::cout << default_config();
        return {};
    }
    for (std::size_t i = 0; i < commands.size(); ++i)
        if (apps[i]->parsed()) {
            invocation.command_flags = options[i].given();
            invocation.command = std::move(commands[i]);
        }
    invocation.common_flags = common_options.given();
    if (!invocation.command && !invocation.print_config) {
        std::cerr << app.help();
        return {{}, int(ErrorKind::usage)};
    }
    return {std::move(invocation), 0};
}

/// All layers into the command's and the common settings. Returns the resolved tables, common
/// first.
std::pair<SettingTable, SettingTable> resolve(Invocation& invocation, CommonSettings& common) {
    std::vector<SettingTable> defaults;  // of all commands, for the names of keys
    for (const auto& command : all_commands()) defaults.push_back(command->settings());
    SettingTable shared = common.table();
    std::vector<const SettingTable*> tables{&shared};
    for (const SettingTable& table : defaults) tables.push_back(&table);

    ConfigFile file;
    if (!invocation.config_file.empty()) file = read_config_file(invocation.config_file);
    refuse_unknown_keys(file, tables);
    resolve_settings(shared, file, invocation.common_flags);
    SettingTable own;
    if (invocation.command) own = invocation.command->settings();
    resolve_settings(own, file, invocation.command_flags);
    start_talk(common.talk);
    for (const std::string& name : unknown_variables(environ, tables))
        spdlog::warn("{} in the environment means nothing to eventide", name);
    return {std::move(shared), std::move(own)};
}

int run_parsed(Signals& signals, std::vector<std::string> arguments) {
    CommonSettings common;
    auto [invocation, exit_code] = parse(arguments, common);
    if (!invocation) return exit_code;
    const auto [shared, own] = resolve(*invocation, common);
    if (invocation->print_config) {
        print_config(std::cout, {&shared, &own}, false);
        return exit_done;
    }
    for (const Positional& positional : invocation->command->positionals())
        if (positional.value != nullptr && positional.value->empty())
            throw Error(ErrorKind::usage,
                        invocation->command->name() + ": expected " + positional.name + hint());
    Program program{signals, std::move(arguments), common.talk.quiet};
    const int result = invocation->command->run(program);
    std::cout.flush();
    return result;
}

}  // namespace

std::string default_config() {
    CommonSettings common;
    const auto commands = all_commands();
    std::vector<SettingTable> defaults;
    for (const auto& command : commands) defaults.push_back(command->settings());
    const SettingTable shared = common.table();
    std::vector<const SettingTable*> tables{&shared};
    for (const SettingTable& table : defaults) tables.push_back(&table);
    std::ostringstream text;
    text << "# Every key, with its default. Use a copy of what you change: eventide --config "
            "my.toml ...\n"
            "# Flags win over the environment (EVENTIDE_RUN_FPS for run.fps), that over this "
            "file.\n\n";
    print_config(text, tables, true);
    return text.str();
}

int run_program(Signals& signals, std::vector<std::string> arguments) {
    start_talk({});
    try {
        return run_parsed(signals, std::move(arguments));
    } catch (const Error& error) {
        spdlog::error("{}", error.what());
        return int(error.kind());
    } catch (const std::exception& error) {
        spdlog::error("{}", error.what());
        return int(ErrorKind::failed);
    }
}

}  // namespace eventide::app
