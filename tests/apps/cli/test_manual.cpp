// The manual page and the completion know every command and every flag.
#include "apps/cli/command_line.h"
#include "apps/cli/program.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace eventide::app {
namespace {

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// As man writes it: hyphens that can be typed again.
std::string typed(std::string flag) {
    std::string out;
    for (const char c : flag) out += c == '-' ? "\\-" : std::string{c};
    return out;
}

TEST(Manual, HasEveryCommandFlagAndExitCode) {
    const std::string page = manual_page();
    for (const auto& command : all_commands()) {
        EXPECT_TRUE(has(page, ".SS \\fBeventide " + command->name())) << command->name();
        for (const Setting& setting : command->settings().settings)
            EXPECT_TRUE(has(page, typed(flag_of(setting)) + "\\fR")) << flag_of(setting);
    }
    EXPECT_TRUE(has(page, "eventide evaluate INPUT..."));
    EXPECT_TRUE(has(page, typed("--log-level")));
    EXPECT_TRUE(has(page, "5 finished but data were lost"));
}

/// Lines that man does not break, so that commands can be copied: sentences among them would leave
/// the screen.
TEST(Manual, BreaksSentencesAndNotCommands) {
    std::istringstream lines{manual_page()};
    bool as_it_is = false;
    int commands = 0;
    for (std::string line; std::getline(lines, line);) {
        if (line == ".nf" || line == ".fi") {
            EXPECT_NE(as_it_is, line == ".nf") << line << " twice";
            as_it_is = line == ".nf";
        } else if (as_it_is) {
            ++commands;
            EXPECT_TRUE(line.starts_with("  ")) << line;
            EXPECT_LE(line.size(), 120U) << line;
        }
    }
    EXPECT_FALSE(as_it_is);
    EXPECT_GT(commands, 30);
}

TEST(Manual, SaysWhatIsAroundTheProgram) {
    const std::string page = manual_page();
    for (const char* section : {"DESCRIPTION", "EXIT STATUS", "ENVIRONMENT", "FILES"})
        EXPECT_TRUE(has(page, std::string{"\n.SH "} + section + "\n")) << section;
    for (const char* heading : {"Output", "Quality", "Input"})
        EXPECT_TRUE(has(page, std::string{"\n\\fB"} + heading + "\\fR\n")) << heading;
    const std::string heading = "\n\\fBQuality\\fR\n";
    EXPECT_EQ(page.find(heading), page.rfind(heading)) << "once, over all options under it";
    EXPECT_TRUE(has(page, "130 and 143"));
}

TEST(Manual, IsTextToMan) {
    const std::string page = manual_page();
    std::istringstream lines{page};
    const std::vector<std::string> macros{".TH", ".SH", ".SS", ".TP", ".PP", ".nf", ".fi"};
    for (std::string line; std::getline(lines, line);) {
        const bool is_macro = line.starts_with(".") || line.starts_with("'");
        EXPECT_TRUE(!is_macro || std::ranges::count(macros, line.substr(0, 3)) == 1) << line;
    }
}

/// What bash offers for the last of these words.
std::string offered(const std::string& words) {
    const test::TempFolder temp;
    test::write_text(temp / "completion", bash_completion());
    const test::Result result =
        test::run({"bash", "-euc",
                   ". " + (temp / "completion") + "; COMP_WORDS=(" + words +
                       "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); COMPREPLY=(); _eventide; "
                       "echo \"${COMPREPLY[*]}\""});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.output;
}

/// What zsh is told to offer: its completion system is stood in for.
std::string offered_by_zsh(const std::string& words, const std::string& typed) {
    const test::TempFolder temp;
    test::write_text(temp / "completion", zsh_completion());
    const test::Result result = test::run(
        {"zsh", "-fec",
         "compadd() { shift; print -- $@ }; _files() { print files }\n"
         "_describe() { local entry; for entry in ${(P)2}; do print -- ${entry%%:*}; done }\n"
         "words=(" +
             words + "); CURRENT=$#words; PREFIX='" + typed + "'; . " + (temp / "completion")});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.output;
}

/// What fish offers, without its descriptions.
std::string offered_by_fish(const std::string& line) {
    const test::TempFolder temp;
    test::write_text(temp / "completion", fish_completion());
    const test::Result result = test::run({"fish", "-N", "-c",
                                           "source " + (temp / "completion") + "; complete -C '" +
                                               line + "' | string replace -r '\\t.*' ''; true"},
                                          {.environment = {{"HOME", temp.path().string()}}});
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return result.output;
}

bool is_here(const std::string& shell) {
    return test::run({"sh", "-c", "command -v " + shell}).exit_code == 0;
}

TEST(Completion, ZshOffersCommandsFlagsAndWords) {
    if (!is_here("zsh")) GTEST_SKIP() << "zsh is not installed";
    EXPECT_TRUE(offered_by_zsh("eventide ''", "").starts_with("run\n"));
    EXPECT_EQ(offered_by_zsh("eventide run a.raw --precision ''", ""), "auto f32 bf16\n");
    EXPECT_TRUE(has(offered_by_zsh("eventide run --", "--"), "\n--lookahead\n"));
    EXPECT_TRUE(has(offered_by_zsh("eventide info --", "--"), "\n--log-level\n"));
    EXPECT_EQ(offered_by_zsh("eventide run rec", "rec"), "files\n");
    EXPECT_EQ(offered_by_zsh("eventide run a.raw --model ''", ""), "files\n");
    EXPECT_EQ(offered_by_zsh("eventide run a.raw --hot-pixels ''", ""), "off learn\nfiles\n");
}

TEST(Completion, FishOffersCommandsFlagsAndWords) {
    if (!is_here("fish")) GTEST_SKIP() << "fish is not installed";
    EXPECT_EQ(offered_by_fish("eventide con"), "convert\n");
    EXPECT_EQ(offered_by_fish("eventide run a.raw --precision "), "auto\nbf16\nf32\n");
    EXPECT_EQ(offered_by_fish("eventide run --looka"), "--lookahead\n");
    EXPECT_EQ(offered_by_fish("eventide info --log"), "--log-level\n");
    EXPECT_EQ(offered_by_fish("eventide run a.raw --noise-filter "), "auto\nmodel\noff\n");
    EXPECT_TRUE(has(offered_by_fish("eventide run a.raw --model /et"), "/etc/\n"));
    EXPECT_TRUE(has(offered_by_fish("eventide run a.raw --hot-pixels /et"), "/etc/\n"));
}

TEST(Completion, OffersCommandsFlagsAndWords) {
    EXPECT_EQ(offered("eventide con"), "convert\n");
    EXPECT_EQ(offered("eventide run --looka"), "--lookahead\n");
    EXPECT_EQ(offered("eventide run a.raw --precision ''"), "auto f32 bf16\n");
    EXPECT_EQ(offered("eventide run a.raw --precision b"), "bf16\n");
    EXPECT_EQ(offered("eventide run rec"), "\n") << "files are bash's own";
    EXPECT_EQ(offered("eventide info --log"), "--log-level\n");
    EXPECT_EQ(offered("eventide run a.raw --noise-filter ''"), "model auto off\n")
        << "TIME stands for a time";
    EXPECT_EQ(offered("eventide run a.raw --model ''"), "\n") << "files are bash's own";
}

}  // namespace
}  // namespace eventide::app
