// The manual page.
#include "apps/cli/manual.h"

#include "apps/cli/program.h"
#include "apps/cli/version.h"

namespace eventide::app {

namespace {

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

void add_command(Command& command, std::string& page) {
    std::string line = "eventide " + command.name();
    for (const Positional& positional : command.positionals())
        line += " " + positional.name + (positional.values != nullptr ? "..." : "");
    page += ".SS " + bold(line) + "\n" + literal(command.summary()) + "\n";
    for (const Positional& positional : command.positionals())
        page += ".TP\n\\fI" + literal(positional.name) + "\\fR\n" + literal(positional.help) + "\n";
    for (const Setting& setting : command.settings().settings) add_setting(setting, page);
    page += ".PP\n.nf\n" + literal(command.examples()) + "\n.fi\n";
}

}  // namespace

std::string manual_page(const SettingTable& common, const Commands& commands) {
    std::string page = ".TH EVENTIDE 1 \"\" \"eventide " + version() +
                       "\"\n.SH NAME\neventide \\- video with uncertainty from event cameras\n"
                       ".SH SYNOPSIS\n" +
                       bold("eventide") +
                       " \\fICOMMAND\\fR [\\fIARGUMENTS\\fR] [\\fIOPTIONS\\fR]\n"
                       ".SH COMMANDS\n";
    for (const auto& command : commands) add_command(*command, page);
    page += ".SH OPTIONS OF ALL COMMANDS\n.TP\n" + bold("--config") +
            " \\fIFILE\\fR\nTOML file with settings.\n.TP\n" + bold("--print-config") +
            "\nShow each value of the command and where it comes from, and exit.\n.TP\n" +
            bold("--default-config") +
            "\nPrint a configuration file with all keys, their meaning and defaults, and exit.\n";
    for (const Setting& setting : common.settings) add_setting(setting, page);
    return page + ".SH EXIT STATUS\n" + literal(kExitCodes) + "\n";
}

}  // namespace eventide::app
