// What only people see: the moving line, colour, and no frames on a terminal.
#include "tests/system/program_test.h"

#include <algorithm>

namespace eventide::test {
namespace {

class Terminal : public ProgramTest {};

TEST_F(Terminal, FramesAreNotWrittenToATerminalUnlessItIsForced) {
    const ProcessSettings terminal{.output_to_terminal = true};
    for (const char* sink : {"-", "gray8:-"}) {
        const std::vector<std::string> run{"run", recording(), "--duration", "1ms", "--out", sink};
        expect(2, run, "--force", terminal);
        std::vector<std::string> forced = run;
        forced.push_back("--force");
        const Result result = eventide(forced, terminal);
        EXPECT_EQ(result.exit_code, 0) << result.error;
        EXPECT_NE(result.output, "");
    }
    expect(2, {"convert", recording(), "-", "--to-format", "evt3"}, "--force", terminal);
    expect(2, {"run", recording(), "--out", "null", "--events-out", "aedat4:-"}, "--force",
           terminal);
    expect(2, {"run", recording(), "--out", "y4m:/dev/stdout"}, "--force", terminal);
    const Result text =
        eventide({"convert", recording(), "-", "--to-format", "text", "--to", "1ms"}, terminal);
    EXPECT_EQ(text.exit_code, 0) << "people can read it";
}

/// What stood on the terminal at some time: the line is drawn again after each return.
std::vector<std::string> drawn_lines(const std::string& text) {
    std::vector<std::string> lines;
    std::size_t begin = 0;
    for (std::size_t end = 0; (end = text.find_first_of("\r\n", begin)) != text.npos;
         begin = end + 1)
        lines.push_back(text.substr(begin, std::min(end, text.find("\033[K", begin)) - begin));
    return lines;
}

TEST_F(Terminal, TheMovingLineFitsTheTerminalAndIsNotForThoseWhoWantQuiet) {
    const std::vector<std::string> run{"run", "sim:demo?size=64x48", "--duration", "700ms", "--out",
                                       "null"};
    for (const int columns : {40, 80, 200}) {
        const std::string text =
            eventide(run, {.error_to_terminal = true, .terminal_columns = columns}).error;
        bool found = false;
        for (const std::string& line : drawn_lines(text)) {
            const bool moving = line.find(" %  ") != line.npos;
            found = found || moving;
            EXPECT_TRUE(!moving || int(line.size()) < columns) << line;
        }
        EXPECT_TRUE(found) << text;
    }
    EXPECT_EQ(eventide(run).error.find('\r'), std::string::npos);
    EXPECT_EQ(eventide(run, {.environment = {{"TERM", "dumb"}}, .error_to_terminal = true})
                  .error.find('\033'),
              std::string::npos)
        << "it would be shown, not obeyed";
    std::vector<std::string> quiet = run;
    quiet.push_back("--quiet");
    EXPECT_EQ(eventide(quiet, {.error_to_terminal = true}).error, "");
}

TEST_F(Terminal, ColourIsForTerminalsAndNoColorIsRespected) {
    const auto throw_usage = [&](ProcessSettings settings) {
        return eventide({"run", "nothing.raw", "--out", "null"}, std::move(settings)).error;
    };
    const std::string escape = "\033[";
    EXPECT_EQ(throw_usage({}).find(escape), std::string::npos);
    EXPECT_NE(
        throw_usage({.environment = {{"TERM", "xterm"}}, .error_to_terminal = true}).find(escape),
        std::string::npos);
    EXPECT_EQ(throw_usage({.environment = {{"TERM", "xterm"}, {"NO_COLOR", "1"}},
                           .error_to_terminal = true})
                  .find(escape),
              std::string::npos);
}

}  // namespace
}  // namespace eventide::test
