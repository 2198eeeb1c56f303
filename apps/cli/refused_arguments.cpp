// What to say of arguments that CLI11 did not understand.
#include "apps/cli/refused_arguments.h"

#include "apps/cli/command_line.h"
#include "src/core/error.h"
#include "src/settings/suggestion.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace eventide::app {

namespace {

std::vector<std::string> flags_of(const CLI::App& app) {
    std::vector<std::string> flags;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    return flags;
}

/// What was meant by a word that is no command: a recording, without the command.
std::string command_suggestion(const std::string& word, const std::vector<std::string>& commands) {
    std::error_code ignored;
    if (!std::filesystem::exists(word, ignored)) return suggestion(word, commands);
    return "; did you mean eventide run " + word + " --out video.mp4?";
}

/// Of what was taken for an option.
std::string file_suggestion(const std::string& word) {
    std::error_code ignored;
    if (!word.starts_with("-") || !std::filesystem::exists(word, ignored)) return {};
    return "; did you mean the file ./" + word + "?";
}

/// As which the program and its commands know a word; null: none.
const CLI::Option* option_named(const std::string& word, const CLI::App& app) {
    if (!word.starts_with("-") || word.size() < 2) return nullptr;
    for (const CLI::App* each : app.get_subcommands(nullptr))
        if (const CLI::Option* found = each->get_option_no_throw(word)) return found;
    return app.get_option_no_throw(word);
}

}  // namespace

std::string command_of(const CLI::App& app) {
    const auto given = app.get_subcommands();
    return given.empty() ? "" : given.front()->get_name();
}

void refuse_extras(const std::vector<std::string>& arguments, const CLI::App& app,
                   const std::string& command) {
    const std::string help = help_hint(command);
    if (command.empty()) {
        std::vector<std::string> names;
        for (const CLI::App* sub : app.get_subcommands(nullptr)) names.push_back(sub->get_name());
        const auto first = std::find_if(arguments.begin(), arguments.end(),
                                        [](const auto& text) { return !text.starts_with("-"); });
        if (first != arguments.end())
            throw Error(ErrorKind::usage, "there is no command '" + *first + "'" +
                                              command_suggestion(*first, names) + help);
    }
    std::vector<std::string> flags = flags_of(app);
    if (!command.empty()) {
        const auto own = flags_of(*app.get_subcommand(command));
        flags.insert(flags.end(), own.begin(), own.end());
    }
    for (const std::string& argument : arguments) {
        if (argument == "--") break;  // behind it nothing is an option
        const std::string flag = argument.substr(0, argument.find('='));
        if (flag.starts_with("--") && std::find(flags.begin(), flags.end(), flag) == flags.end())
            throw Error(ErrorKind::usage, "there is no option " + flag + file_suggestion(argument) +
                                              suggestion(flag, flags) + help);
    }
    // CLI11 has them in an order of its own.
    std::vector<std::string> remaining = app.remaining(true);
    std::string left, files;
    bool output = command == "run";
    for (const std::string& argument : arguments) {
        const auto found = std::ranges::find(remaining, argument);
        if (found == remaining.end()) continue;
        remaining.erase(found);
        if (argument == "--") continue;
        left += (left.empty() ? "'" : " '") + argument + "'";
        files += file_suggestion(argument);
        output = output && !argument.starts_with("-");
    }
    throw Error(ErrorKind::usage,
                "unexpected argument " + left + (output ? "; did you mean --out?" : files) + help);
}

void refuse_forgotten_values(const std::vector<std::string>& arguments, const CLI::App& app) {
    for (std::size_t i = 0; i + 1 < arguments.size() && arguments[i + 1] != "--"; ++i) {
        const CLI::Option* option = option_named(arguments[i], app);
        const std::string& next = arguments[i + 1];
        if (option == nullptr || option->get_items_expected_min() == 0) continue;
        if (next.starts_with("--") && option_named(next, app) != nullptr)
            throw Error(ErrorKind::usage, arguments[i] + ": expected " + option->get_type_name() +
                                              ", found the option " + next);
    }
}

std::string in_our_words(const std::string& text) {
    const std::string_view before = ": 1 required ", after = " missing";
    const std::size_t at = text.find(before);
    if (at == text.npos || !text.ends_with(after)) return text;
    const std::size_t value = at + before.size();
    return text.substr(0, at) + ": expected " +
           text.substr(value, text.size() - after.size() - value) + ", found none";
}

}  // namespace eventide::app
