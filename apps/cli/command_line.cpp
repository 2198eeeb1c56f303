// CLI11's part: options out of tables of settings, and help.
#include "apps/cli/command_line.h"

#include "apps/cli/program.h"
#include "apps/cli/refused_arguments.h"
#include "apps/cli/version.h"
#include "src/core/error.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <iostream>
#include <sstream>
#include <utility>

namespace eventide::app {

namespace {

constexpr std::size_t kColumns = 79;      // of any terminal, and one for its cursor
constexpr std::size_t kHelpColumns = 48;  // beside CLI11's column of names

std::string wrapped(const std::string& text, std::size_t width = kHelpColumns) {
    std::string lines, line;
    std::istringstream words{text};
    for (std::string word; words >> word;) {
        if (!line.empty() && line.size() + 1 + word.size() > width)
            lines += std::exchange(line, "") + "\n";
        line += (line.empty() ? "" : " ") + word;
    }
    return lines + line;
}

/// A command in as many lines as it takes, each an option's beginning.
std::string wrapped_command(std::string line) {
    std::string lines;
    while (line.size() > kColumns) {
        const std::size_t at = line.rfind(" --", kColumns - 2);
        if (at == line.npos || at < 8) break;
        lines += line.substr(0, at) + " \\\n";
        line = "     " + line.substr(at);
    }
    return lines + line;
}

/// What stands below the options: paragraphs, and commands, which are set in by two columns.
std::string footer_of(const std::string& text) {
    std::string lines;
    std::istringstream paragraphs{text};
    for (std::string line; std::getline(paragraphs, line);)
        lines += (lines.empty() ? "" : "\n") +
                 (line.starts_with("  ") ? wrapped_command(line) : wrapped(line, kColumns));
    return lines;
}

std::string group_of(const Setting& setting) {
    return setting.group.empty() ? "Options" : setting.group;
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

    /// For --help: what they do and what they are by default, of the table that was added.
    void describe(const SettingTable& table) {
        for (std::size_t i = 0; i < entries_.size(); ++i)
            entries_[i].option->description(wrapped(help_with_default(table.settings[i])));
    }

    FlagValues given() const {
        FlagValues values;
        for (const Entry& entry : entries_) {
            const bool off = entry.opposite != nullptr && entry.opposite->count() > 0;
            if (entry.option->count() == 0 && !off) continue;
            if (off && entry.option->count() > 0)
                throw Error(ErrorKind::usage, "--" + entry.option->get_lnames().front() +
                                                  " and --" + entry.opposite->get_lnames().front() +
                                                  " contradict each other");
            values[entry.key] = off ? std::vector<std::string>{"false"} : entry.option->results();
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
        CLI::Option* option = app.add_flag(flag)->group(group_of(setting));
        entries_.push_back({setting.key, option, opposite});
    }

    void add_option(CLI::App& app, const Setting& setting) {
        const std::string flag = flag_of(setting);
        const std::string names =
            setting.short_flag.empty() ? flag : setting.short_flag + "," + flag;
        CLI::Option* option = app.add_option(names);
        // One value each: `--out a/ b` must not swallow b.
        option->group(group_of(setting))
            ->type_name(setting.value_name)
            ->expected(1)
            ->multi_option_policy(setting.kind == ValueKind::list
                                      ? CLI::MultiOptionPolicy::TakeAll
                                      : CLI::MultiOptionPolicy::TakeLast);
        option->allow_extra_args(false);
        entries_.push_back({setting.key, option, nullptr});
    }

    std::vector<Entry> entries_;
};

void add(CLI::App& app, const Positional& positional) {
    CLI::Option* option = positional.value != nullptr
                              ? app.add_option(positional.name, *positional.value)
                              : app.add_option(positional.name, *positional.values);
    option->type_name("")->description(wrapped(positional.help));
}

/// A command that can be given.
struct Offered {
    std::unique_ptr<Command> command;
    CLI::App* app = nullptr;
    Options options;  // none where no argument names it
};

Offered offer(CLI::App& app, std::unique_ptr<Command> command,
              const std::vector<std::string>& arguments) {
    Offered offered{std::move(command), nullptr, {}};
    const std::string name = offered.command->name();
    offered.app = app.add_subcommand(name);
    // What no argument names is not the one given: hundreds of options less to make.
    if (std::ranges::find(arguments, name) == arguments.end()) return offered;
    for (const Positional& positional : offered.command->positionals())
        add(*offered.app, positional);
    offered.options.add(*offered.app, offered.command->settings());
    return offered;
}

/// All the words of --help, which take longer to make than arguments to read.
void describe(CLI::App& app, std::vector<Offered>& commands, Options& common_options,
              const SettingTable& common) {
    app.footer(
        footer_of(std::string{"Examples:\n"
                              "  eventide run recording.aedat4 --out video.mp4\n"
                              "  eventide info recording.raw\n"
                              "  eventide run recording.aedat4 --fps 200 --out - | ffplay -\n"
                              "eventide COMMAND --help lists the options of a command.\n"
                              "Exit codes: "} +
                  kExitCodes));
    common_options.describe(common);
    for (Offered& each : commands) {
        each.app->description(wrapped(each.command->summary()));
        each.app->footer(footer_of(each.command->examples()));
        each.options.describe(each.command->settings());
    }
}

/// "help" and "help COMMAND" are "--help" and "COMMAND --help".
std::vector<std::string> with_help_as_flag(std::vector<std::string> arguments) {
    if (arguments.empty() || arguments.front() != "help") return arguments;
    arguments.erase(arguments.begin());
    arguments.emplace_back("--help");
    return arguments;
}

}  // namespace

std::string help_hint(const std::string& command) {
    return "; see eventide " + (command.empty() ? "" : command + " ") + "--help";
}

namespace {

/// False where --help or --version was asked for and answered; `describe_all` fills in what --help
/// shows.
bool parse(CLI::App& app, const std::vector<std::string>& arguments,
           const std::function<void()>& describe_all) {
    try {
        // CLI11 takes them from the back.
        app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
        return true;
    } catch (const CLI::Success& success) {
        if (command_of(app).empty() && !arguments.front().starts_with("-"))
            refuse_extras(arguments, app, {});
        describe_all();
        app.exit(success, std::cout, std::cerr);
        return false;
    } catch (const CLI::ExtrasError&) {
        refuse_extras(arguments, app, command_of(app));
    } catch (const CLI::ParseError& error) {
        throw Error(ErrorKind::usage, in_our_words(error.what()) + help_hint(command_of(app)));
    }
}

}  // namespace

Parsed parse_command_line(const std::vector<std::string>& given, const SettingTable& common) {
    const std::vector<std::string> arguments = with_help_as_flag(given);
    CLI::App app{"Video with uncertainty from event cameras, in real time.", "eventide"};
    app.set_version_flag("--version", version_text);
    app.require_subcommand(0, 1);
    app.fallthrough();
    Invocation invocation;
    bool print_defaults = false;
    const CLI::Option* const config =
        app.add_option("--config", invocation.config_file, "TOML file with settings")
            ->type_name("FILE")
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast)
            ->envname("EVENTIDE_CONFIG");
    app.add_flag("--print-config", invocation.print_config,
                 wrapped("Show each value of the command and where it comes from, and exit"));
    app.add_flag("--default-config", print_defaults,
                 wrapped("Print a configuration file with all keys, their meaning and defaults, "
                         "and exit"));
    Options common_options;
    common_options.add(app, common);

    std::vector<Offered> commands;
    for (auto& command : all_commands())
        commands.push_back(offer(app, std::move(command), arguments));
    const auto describe_all = [&] { describe(app, commands, common_options, common); };
    refuse_forgotten_values(arguments, app);
    if (!parse(app, arguments, describe_all)) return {};
    if (config->count() > 0 && invocation.config_file.empty())
        throw Error(ErrorKind::usage, "--config: expected FILE, found ''" + help_hint({}));
    if (print_defaults) {
        std::cout << default_config();
        return {};
    }
    for (Offered& each : commands)
        if (each.app->parsed()) {
            invocation.command_flags = each.options.given();
            invocation.command = std::move(each.command);
        }
    invocation.common_flags = common_options.given();
    if (!invocation.command && !invocation.print_config) {
        describe_all();
        std::cerr << app.help();
        return {{}, int(ErrorKind::usage)};
    }
    return {std::move(invocation), 0};
}

}  // namespace eventide::app
