// Resolves the configuration, runs a command, and says what went wrong.
#include "apps/cli/program.h"

#include "apps/cli/command_line.h"
#include "apps/cli/manual.h"
#include "apps/cli/settings/config.h"
#include "apps/cli/terminal.h"
#include "src/core/error.h"
#include "src/io/system_words.h"
#include "src/settings/suggestion.h"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <opencv2/core.hpp>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>
#include <sstream>
#include <utility>

namespace eventide::app {

namespace {

/// What all commands share.
struct CommonSettings {
    LogSettings log;

    SettingTable table() {
        SettingTable common{"", "What all commands share.", {}};
        common.settings.push_back(parsed_setting<std::string>(
            "log_level", log.log_level, "LEVEL",
            "Level of the log on standard error: trace, debug, info, warning, error or off.",
            [](const std::string& text) {
                parse_choice(text, {"trace", "debug", "info", "warning", "error", "off"});
                return text;
            },
            [](const std::string& text) { return text; }));
        common.settings.push_back(flag_setting(
            "quiet", log.quiet, "No progress and no summaries; warnings and errors stay."));
        return common;
    }
};

std::vector<std::string> variables_of(const std::vector<const SettingTable*>& tables) {
    std::vector<std::string> names;
    for (const SettingTable* table : tables)
        for (const Setting& setting : table->settings)
            names.push_back(environment_of(*table, setting));
    return names;
}

/// All layers into the command's and the common settings. Returns the resolved tables, common
/// first.
std::pair<SettingTable, SettingTable> resolve(Invocation& invocation, CommonSettings& common) {
    std::vector<SettingTable> defaults;  // of all commands, for the names of keys
    for (const auto& command : all_commands()) defaults.push_back(command->settings());
    SettingTable shared = common.table();
    std::vector<const SettingTable*> tables{&shared};
    tables.reserve(1 + defaults.size());
    for (const SettingTable& table : defaults) tables.push_back(&table);

    ConfigFile file;
    if (!invocation.config_file.empty()) file = read_config_file(invocation.config_file);
    refuse_unknown_keys(file, tables);
    resolve_settings(shared, file, invocation.common_flags);
    SettingTable own;
    if (invocation.command) own = invocation.command->settings();
    resolve_settings(own, file, invocation.command_flags);
    start_log(common.log);
    for (const std::string& name : unknown_variables(environ, tables))
        spdlog::warn("unknown variable {} in the environment{}", name,
                     suggestion(name, variables_of(tables)));
    return {std::move(shared), std::move(own)};
}

int run_parsed(Signals& signals, std::vector<std::string> arguments) {
    CommonSettings common;
    auto [invocation, exit_code] = parse_command_line(arguments, common.table());
    if (!invocation) return exit_code;
    const auto [shared, own] = resolve(*invocation, common);
    if (invocation->print_config) {
        print_config(std::cout, {&shared, &own}, false);
        return exit_done;
    }
    for (const Positional& positional : invocation->command->positionals())
        if (positional.value != nullptr && positional.value->empty())
            throw Error(ErrorKind::usage, invocation->command->name() + ": expected " +
                                              positional.name +
                                              help_hint(invocation->command->name()));
    Program program{signals, std::move(arguments), common.log.quiet};
    for (const auto& [key, values] : invocation->command_flags) program.flags.insert(key);
    program.files.reads("--config", invocation->config_file);
    return invocation->command->run(program);
}

/// What was printed may still be in a buffer. A reader that went away is no error.
void finish_standard_output() {
    errno = 0;
    const bool written = std::cout.flush() && std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
    // Why an earlier part failed was told nobody: one more byte fails for the same reason.
    if (!written && errno == 0) [[maybe_unused]]
        const auto count = ::write(STDOUT_FILENO, "\n", 1);
    const int error = errno;
    pollfd reader{STDOUT_FILENO, 0, 0};
    const bool gone =
        error == EPIPE || (::poll(&reader, 1, 0) == 1 && (reader.revents & POLLERR) != 0);
    if (!written && !gone)
        throw Error(ErrorKind::failed,
                    "standard output: cannot be written" +
                        (error == 0 ? std::string{} : ": " + system_words(error)));
}

}  // namespace

std::string default_config() {
    CommonSettings common;
    const auto commands = all_commands();
    std::vector<SettingTable> defaults;
    defaults.reserve(commands.size());
    for (const auto& command : commands) defaults.push_back(command->settings());
    const SettingTable shared = common.table();
    std::vector<const SettingTable*> tables{&shared};
    tables.reserve(1 + defaults.size());
    for (const SettingTable& table : defaults) tables.push_back(&table);
    std::ostringstream text;
    text << "# Every key, with its default. Use a copy of what you change: eventide --config "
            "my.toml ...\n"
            "# Flags win over the environment (EVENTIDE_RUN_FPS for run.fps), that over this "
            "file.\n\n";
    print_config(text, tables, true);
    return text.str();
}

std::string manual_page() {
    CommonSettings common;
    return manual_page(common.table(), all_commands());
}

std::string bash_completion() {
    CommonSettings common;
    return bash_completion(common.table(), all_commands());
}

std::string zsh_completion() {
    CommonSettings common;
    return zsh_completion(common.table(), all_commands());
}

std::string fish_completion() {
    CommonSettings common;
    return fish_completion(common.table(), all_commands());
}

namespace {

int out_of_memory() {
    spdlog::error(
        "out of memory: expected enough for the sensor's size, --size and the buffers, found less");
    return int(ErrorKind::failed);
}

}  // namespace

int run_program(Signals& signals, std::vector<std::string> arguments) {
    start_log({});
    try {
        const int result = run_parsed(signals, std::move(arguments));
        finish_standard_output();
        return result;
    } catch (const Error& error) {
        spdlog::error("{}", error.what());
        return int(error.kind());
    } catch (const std::bad_alloc&) {
        return out_of_memory();
    } catch (const std::system_error& error) {
        spdlog::error("{}", system_words(error));
        return int(ErrorKind::failed);
    } catch (const std::exception& error) {
        const auto* of_opencv = dynamic_cast<const cv::Exception*>(&error);
        if (of_opencv != nullptr && of_opencv->code == cv::Error::StsNoMem) return out_of_memory();
        spdlog::error("{}", error.what());
        return int(ErrorKind::failed);
    }
}

}  // namespace eventide::app
