// The manual page.
#include "apps/cli/manual.h"

#include "apps/cli/program.h"
#include "apps/cli/version.h"

#include <initializer_list>
#include <sstream>
#include <utility>

namespace eventide::app {

namespace {

constexpr const char* kDescription =
    "Turns the output of an event camera, live or recorded, into video at any frame rate and size, "
    "with sigma: the standard deviation of the intensity, 0 to 1, that the network expects at each "
    "pixel. Data go to files or to standard output, messages to standard error. No output "
    "overwrites an input, and no file is replaced without --overwrite.";

/// Text as man's macros take it: nothing in it is a macro, and hyphens can be typed again.
std::string literal(const std::string& text) {
    std::string out;
    bool line_begins = true;
    for (const char c : text) {
        if (line_begins && (c == '.' || c == '\'')) out += "\\&";
        if (c == '\\')
            out += "\\e";
        else if (c == '-')
            out += "\\-";
        else
            out += c;
        line_begins = c == '\n';
    }
    return out;
}

std::string bold(const std::string& text) {
    return "\\fB" + literal(text) + "\\fR";
}

void add_setting(const Setting& setting, std::string& page) {
    page += ".TP\n" +
            bold((setting.short_flag.empty() ? "" : setting.short_flag + ", ") + flag_of(setting));
    if (!setting.value_name.empty()) page += " \\fI" + literal(setting.value_name) + "\\fR";
    page += "\n" + literal(help_with_default(setting)) + "\n";
}

/// Sentences, each line a paragraph; behind them commands, which begin with blanks, as they are.
void add_examples(const std::string& text, std::string& page) {
    bool commands = false;
    std::istringstream lines{text};
    for (std::string line; std::getline(lines, line);) {
        const bool command = line.starts_with(' ');
        if (command && !commands) page += ".nf\n";
        if (!command) page += commands ? ".fi\n.PP\n" : ".PP\n";
        page += literal(line) + "\n";
        commands = command;
    }
    if (commands) page += ".fi\n";
}

void add_command(Command& command, std::string& page) {
    std::string line = "eventide " + command.name();
    for (const Positional& positional : command.positionals())
        line += " " + positional.name + (positional.values != nullptr ? "..." : "");
    page += ".SS " + bold(line) + "\n" + literal(command.summary()) + "\n";
    for (const Positional& positional : command.positionals())
        page += ".TP\n\\fI" + literal(positional.name) + "\\fR\n" + literal(positional.help) + "\n";
    std::string group;
    for (const Setting& setting : command.settings().settings) {
        if (setting.group != group) page += ".PP\n" + bold(setting.group) + "\n";
        group = setting.group;
        add_setting(setting, page);
    }
    add_examples(command.examples(), page);
}

/// Names, each with what it is for.
void add_list(const std::string& title,
              std::initializer_list<std::pair<const char*, const char*>> entries,
              std::string& page) {
    page += ".SH " + title + "\n";
    for (const auto& [name, meaning] : entries)
        page += ".TP\n" + bold(name) + "\n" + literal(meaning) + "\n";
}

void add_surroundings(std::string& page) {
    add_list("ENVIRONMENT",
             {{"EVENTIDE_COMMAND_OPTION",
               "Any option, such as EVENTIDE_RUN_FPS=60; lists are split at ;. Flags win over the "
               "environment, and that over the configuration file."},
              {"EVENTIDE_CONFIG", "The configuration file, as --config names it."},
              {"EVENTIDE_MODELS", "Folder in which models are looked for by name first."},
              {"NO_COLOR", "No colour in messages."},
              {"XDG_CACHE_HOME",
               "Where what was measured of the processor is kept (~/.cache), in eventide/."},
              {"HDF5_PLUGIN_PATH", "Plug-ins of the HDF5 library, for packed recordings."},
              {"ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, CYCLONEDDS_URI", "As for nodes of ROS 2."}},
             page);
    add_list("FILES",
             {{"share/eventide/default.toml", "A configuration file with every key."},
              {"share/eventide/cameras/", "Settings of cameras, to be copied for --camera."},
              {"share/eventide/models/", "The models that have a name."},
              {"share/doc/eventide/docs/", "The documentation; usage.md explains every option."}},
             page);
}

}  // namespace

std::string manual_page(const SettingTable& common, const Commands& commands) {
    std::string page = ".TH EVENTIDE 1 \"\" \"eventide " + version() +
                       "\"\n.SH NAME\neventide \\- video with uncertainty from event cameras\n"
                       ".SH SYNOPSIS\n" +
                       bold("eventide") +
                       " \\fICOMMAND\\fR [\\fIARGUMENTS\\fR] [\\fIOPTIONS\\fR]\n"
                       ".SH DESCRIPTION\n" +
                       literal(kDescription) + "\n.SH COMMANDS\n";
    for (const auto& command : commands) add_command(*command, page);
    page += ".SH OPTIONS OF ALL COMMANDS\n.TP\n" + bold("--config") +
            " \\fIFILE\\fR\nTOML file with settings.\n.TP\n" + bold("--print-config") +
            "\nShow each value of the command and where it comes from, and exit.\n.TP\n" +
            bold("--default-config") +
            "\nPrint a configuration file with all keys, their meaning and defaults, and exit.\n";
    for (const Setting& setting : common.settings) add_setting(setting, page);
    page += ".SH EXIT STATUS\n" + literal(kExitCodes) + "\n";
    add_surroundings(page);
    return page;
}

}  // namespace eventide::app
