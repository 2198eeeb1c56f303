// What bash, zsh and fish offer while a command line is typed.
#include "apps/cli/manual.h"

#include <algorithm>
#include <sstream>
#include <utility>

namespace eventide::app {

namespace {

/// A flag with what a shell says of it.
struct Flag {
    std::string flag, short_flag = {}, help;
    std::string choice = {};  ///< "auto f32 bf16", of a value that is one of a few words
    bool or_file = false;     ///< which may also be a file
    bool takes_value = false;
};

/// What "off|learn|FILE" says can be typed: "off learn", and a file. Capitals stand for something
/// else than themselves.
struct Values {
    std::string words;
    bool file = false;
};

Values values_of(const Setting& setting) {
    Values values;
    if (setting.value_name.find('|') == std::string::npos) return values;
    std::istringstream names{setting.value_name};
    for (std::string name; std::getline(names, name, '|');) {
        if (std::ranges::none_of(name, [](char c) { return c >= 'A' && c <= 'Z'; }))
            values.words += (values.words.empty() ? "" : " ") + name;
        values.file = values.file || name == "FILE";
    }
    return values;
}

/// The first sentence, without its end.
std::string first_sentence(const std::string& help) {
    std::string sentence = help.substr(0, help.find(". "));
    if (sentence.ends_with('.')) sentence.pop_back();
    return sentence;
}

/// The command's own, those all share, and the three that are in no table.
std::vector<Flag> flags_of(Command& command, const SettingTable& common) {
    std::vector<Flag> flags;
    const auto add = [&](const SettingTable& table) {
        for (const Setting& setting : table.settings) {
            const Values values = values_of(setting);
            flags.push_back({flag_of(setting), setting.short_flag, first_sentence(setting.help),
                             values.words, values.file, !setting.value_name.empty()});
        }
    };
    add(command.settings());
    add(common);
    flags.push_back({.flag = "--config", .help = "TOML file with settings", .takes_value = true});
    flags.push_back(
        {.flag = "--print-config", .help = "Show each value and where it comes from, and exit"});
    flags.push_back({.flag = "--help", .short_flag = "-h", .help = "Show every option, and exit"});
    return flags;
}

/// A word of zsh and fish: nothing in it is special.
std::string quoted(const std::string& text, const std::string& quote) {
    std::string out = "'";
    for (const char c : text) {
        if (c == '\'')
            out += quote;
        else
            out += c;
    }
    return out + "'";
}

std::string for_zsh(const std::string& text) {
    return quoted(text, "'\\''");
}

std::string for_fish(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '\\') escaped += '\\';
        escaped += c;
    }
    return quoted(escaped, "\\'");
}

}  // namespace

std::string bash_completion(const SettingTable& common, const Commands& commands) {
    std::string names, flag_cases, word_cases;
    for (const auto& command : commands) {
        std::string flags;
        for (const Flag& flag : flags_of(*command, common)) {
            flags += (flags.empty() ? "" : " ") + flag.flag;
            if (!flag.choice.empty())
                word_cases += "        \"" + command->name() + " " + flag.flag + "\") choice=\"" +
                              flag.choice + "\" ;;\n";
        }
        names += (names.empty() ? "" : " ") + command->name();
        flag_cases += "        " + command->name() + ") choice=\"" + flags + "\" ;;\n";
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

std::string zsh_completion(const SettingTable& common, const Commands& commands) {
    std::string names, flag_cases, word_cases;
    for (const auto& command : commands) {
        std::string flags;
        for (const Flag& flag : flags_of(*command, common)) {
            flags += "            " + for_zsh(flag.flag + ":" + flag.help) + "\n";
            if (!flag.choice.empty())
                word_cases += "        " + for_zsh(command->name() + " " + flag.flag) +
                              ") compadd -- " + flag.choice + (flag.or_file ? "; _files" : "") +
                              "; return ;;\n";
        }
        names += "            " + for_zsh(command->name() + ":" + command->summary()) + "\n";
        flag_cases += "        " + command->name() + ") choice=(\n" + flags + "        ) ;;\n";
    }
    return "#compdef eventide\n"
           "_eventide() {\n"
           "    local -a choice\n"
           "    if (( CURRENT == 2 )); then\n"
           "        choice=(\n" +
           names +
           "            '--help:Show the commands, and exit'\n"
           "            '--version:Show the version, and exit'\n"
           "            '--default-config:Print a configuration file with all keys, and exit'\n"
           "        )\n"
           "        _describe command choice\n"
           "        return\n"
           "    fi\n"
           "    case \"$words[2] $words[CURRENT-1]\" in\n" +
           word_cases +
           "    esac\n"
           "    if [[ $PREFIX != -* ]]; then\n"
           "        _files\n"
           "        return\n"
           "    fi\n"
           "    case $words[2] in\n" +
           flag_cases +
           "    esac\n"
           "    _describe option choice\n"
           "}\n"
           "_eventide \"$@\"\n";
}

std::string fish_completion(const SettingTable& common, const Commands& commands) {
    std::string text = "# fish completion of eventide\n";
    const std::string complete = "complete -c eventide ";
    for (const auto& command : commands)
        text += complete + "-n __fish_use_subcommand -f -a " + command->name() + " -d " +
                for_fish(command->summary()) + "\n";
    for (const auto& [flag, help] :
         {std::pair{"help", "Show the commands, and exit"},
          std::pair{"version", "Show the version, and exit"},
          std::pair{"default-config", "Print a configuration file with all keys, and exit"}})
        text += complete + "-n __fish_use_subcommand -l " + flag + " -d " + for_fish(help) + "\n";
    for (const auto& command : commands)
        for (const Flag& flag : flags_of(*command, common)) {
            text += complete + "-n '__fish_seen_subcommand_from " + command->name() + "' -l " +
                    flag.flag.substr(2);
            if (!flag.short_flag.empty()) text += " -s " + flag.short_flag.substr(1);
            if (!flag.choice.empty())
                text += (flag.or_file ? " -r -a " : " -x -a ") + for_fish(flag.choice);
            else if (flag.takes_value)
                text += " -r";
            text += " -d " + for_fish(flag.help) + "\n";
        }
    return text;
}

}  // namespace eventide::app
