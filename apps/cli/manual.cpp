// The manual page and the shell's completion.
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

/// The words of a setting that takes one of a few: "auto|f32|bf16".
std::string words_of(const Setting& setting) {
    std::string words = setting.value_name;
    if (words.find('|') == words.npos) return {};
    for (char& c : words)
        if (c == '|') c = ' ';
    return words;
}

/// The lines of a bash case: what may follow a flag, and which flags there are.
struct Choices {
    std::string words, flags;

    void add(const std::string& command, const SettingTable& table) {
        for (const Setting& setting : table.settings) {
            flags += flag_of(setting) + " ";
            if (const std::string choice = words_of(setting); !choice.empty())
                words += "        \"" + command + " " + flag_of(setting) + "\") choice=\"" +
                         choice + "\" ;;\n";
        }
    }
};

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

std::string bash_completion(const SettingTable& common, const Commands& commands) {
    std::string names, flag_cases, word_cases;
    for (const auto& command : commands) {
        Choices choices;
        choices.add(command->name(), command->settings());
        choices.add(command->name(), common);
        names += (names.empty() ? "" : " ") + command->name();
        flag_cases += "        " + command->name() + ") choice=\"" + choices.flags +
                      "--config --print-config --help\" ;;\n";
        word_cases += choices.words;
    }
    return "# bash completion of eventide\n"
           "_eventide() {\n"
           "    local word=${COMP_WORDS[COMP_CWORD]} choice=\n"
           "    case \"${COMP_WORDS[1]} ${COMP_WORDS[COMP_CWORD - 1]}\" in\n" +
           word_cases +
           "    esac\n"
           "    if [ -z \"$choice\" ] && [ \"$COMP_CWORD\" -eq 1 ]; then choice=\"" +
           names +
           " --help --version --default-config\"; fi\n"
           "    if [ -z \"$choice\" ]; then\n"
           "        case \"$word\" in -*) ;; *) return ;; esac\n"
           "        case \"${COMP_WORDS[1]}\" in\n" +
           flag_cases +
           "        esac\n"
           "    fi\n"
           "    COMPREPLY=($(compgen -W \"$choice\" -- \"$word\"))\n"
           "}\n"
           "complete -o bashdefault -o default -F _eventide eventide\n";
}

}  // namespace eventide::app
