// Flags win over the environment, that over the file, that over the defaults; mistakes are named.
#include "apps/cli/settings/config.h"
#include "src/core/error.h"
#include "src/settings/toml_text.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

namespace eventide::app {
namespace {

using test::TempFolder;

/// A command with one setting of each kind.
struct Example {
    std::string name = "x";
    double rate = 1;
    bool fast = false;
    std::vector<std::string> out{"a"};

    SettingTable table() {
        return {
            "example",
            "An example.",
            {text_setting("name", name, "NAME", "A name."),
             number_setting("rate", rate, "N", "A rate.", 0, 10),
             flag_setting("fast", fast, "Be fast."), list_setting("out", out, "OUT", "Outputs.")}};
    }
};

std::string complaint(const std::string& toml) {
    const TempFolder temp;
    test::write_text(temp / "c.toml", toml);
    Example example;
    SettingTable table = example.table();
    try {
        const ConfigFile file = read_config_file(temp / "c.toml");
        refuse_unknown_keys(file, {&table});
        resolve_settings(table, file, {});
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::usage);
        return std::string{error.what()}.substr(0, 300);
    }
    return "";
}

TEST(Config, EachLayerWinsOverTheOneBelow) {
    const TempFolder temp;
    test::write_text(temp / "c.toml",
                     "[example]\nname = \"file\"\nrate = 2\nfast = true\nout = [\"f\", \"g\"]\n");
    const ConfigFile file = read_config_file(temp / "c.toml");
    Example example;
    SettingTable table = example.table();
    setenv("EVENTIDE_EXAMPLE_RATE", "3", 1);
    setenv("EVENTIDE_EXAMPLE_OUT", "p;q", 1);
    resolve_settings(table, file, {{"out", {"-"}}});
    unsetenv("EVENTIDE_EXAMPLE_RATE");
    unsetenv("EVENTIDE_EXAMPLE_OUT");
    EXPECT_EQ(example.name, "file");
    EXPECT_EQ(example.rate, 3);
    EXPECT_TRUE(example.fast);
    EXPECT_EQ(example.out, std::vector<std::string>{"-"});
    EXPECT_EQ(table.settings[0].origin, "file " + (temp / "c.toml") + ":2");
    EXPECT_EQ(table.settings[1].origin, "environment EVENTIDE_EXAMPLE_RATE");
    EXPECT_EQ(table.settings[3].origin, "flag --out");
}

TEST(Config, ListsInTheEnvironmentAreCutAtSemicolons) {
    Example example;
    SettingTable table = example.table();
    setenv("EVENTIDE_EXAMPLE_OUT", "a/;b.mp4", 1);
    resolve_settings(table, {}, {});
    unsetenv("EVENTIDE_EXAMPLE_OUT");
    EXPECT_EQ(example.out, (std::vector<std::string>{"a/", "b.mp4"}));
}

/// As EVENTIDE_RUN_FPS= in the file of a service.
TEST(Config, AnEmptyVariableSaysNothing) {
    Example example;
    SettingTable table = example.table();
    setenv("EVENTIDE_EXAMPLE_NAME", "", 1);
    setenv("EVENTIDE_EXAMPLE_OUT", "", 1);
    resolve_settings(table, {}, {});
    unsetenv("EVENTIDE_EXAMPLE_NAME");
    unsetenv("EVENTIDE_EXAMPLE_OUT");
    EXPECT_EQ(example.name, "x");
    EXPECT_EQ(example.out, std::vector<std::string>{"a"});
}

TEST(Config, AListOfOneIsATextInTheFile) {
    const TempFolder temp;
    test::write_text(temp / "c.toml", "[example]\nout = \"b.mp4\"\n");
    Example example;
    SettingTable table = example.table();
    resolve_settings(table, read_config_file(temp / "c.toml"), {});
    EXPECT_EQ(example.out, std::vector<std::string>{"b.mp4"});
}

TEST(Config, AFlagMayTakeBackWhatTheFileSays) {
    const TempFolder temp;
    test::write_text(temp / "c.toml", "[example]\nfast = true\n");
    Example example;
    SettingTable table = example.table();
    resolve_settings(table, read_config_file(temp / "c.toml"), {{"fast", {"false"}}});
    EXPECT_FALSE(example.fast);
}

TEST(Config, MistakesAreNamedWithTheirLine) {
    EXPECT_EQ(complaint("[example]\nname = \"a\"\n"), "");
    EXPECT_LT(complaint("[example]\n" + std::string(1 << 20, 'x') + " = 1\n").size(), 500U);
    EXPECT_NE(complaint("[example]\nname = \"a\"\nnmae = \"b\"\n").find("c.toml:3: unknown key"),
              std::string::npos);
    EXPECT_NE(complaint("\nexample.rates = 2\n").find("c.toml:2"), std::string::npos);
    EXPECT_NE(complaint("\nexample.rates = 2\n").find("'; did you mean example.rate?"),
              std::string::npos);
    EXPECT_EQ(complaint("top = 1\n").find("did you mean"), std::string::npos);
    EXPECT_NE(complaint("top = 1\n").find("c.toml:1"), std::string::npos);
    EXPECT_NE(complaint("[example]\nrate = 99\n").find("c.toml:2: expected a number"),
              std::string::npos);
    EXPECT_NE(complaint("[example]\nrate = true\n").find("expected a number, found true or false"),
              std::string::npos);
    EXPECT_NE(complaint("[example]\nfast = \"yes\"\n").find("expected true or false"),
              std::string::npos);
    EXPECT_NE(complaint("[example]\nname = [\"a\"]\n").find("expected text"), std::string::npos);
    EXPECT_NE(complaint("[example]\nname = 2026-01-01\n").find("c.toml:2"), std::string::npos);
    EXPECT_NE(complaint("[example\nname = 1\n").find("c.toml:1: not TOML"), std::string::npos);
    EXPECT_NE(complaint("[example.deeper]\nname = 1\n").find("c.toml:"), std::string::npos);
}

TEST(Config, NamesOfTablesThatAreNoneAreRefusedBeforeTomlTakesThemForGranted) {
    for (const char* text :
         {"[?un]\nfps = 20\n", "[[[_un]", "[ [x]]", "a = 1\n  [[ \x7f]]\n", "[=]", "[\xc3\xa9]",
          "a = 44+4\xcc\x9f", "[a] \xc3\xa9", "[\n]", "[[\r\n]]", "\xEF\xBB\xBF[?]",
          "a = [\n1] # [\n[ \n", "a = 'x\n[\n", "a = \"\"\"[\n\\\"\"\"\"\n[ \n"})
        EXPECT_THROW(plain_toml("c.toml", text), Error) << text;
    for (const char* text : {"[run]\n", " [ \"a b\" ]\n", "[[x]]", "[", "[]", "out = [\n[\n'a' ]]",
                             "a = \"\"\"\n[\n\"\"\"\n", "a = \'\'\'\n[?\'\'\'\'\'\n[run]",
                             "# [\xc3\xa9\n", "[\"\xc3\xa9\"] # \xc3\xa9\na = '\xc3\xa9'"})
        EXPECT_NO_THROW(plain_toml("c.toml", text)) << text;
}

TEST(Config, ABraceInPlaceOfAListsValueIsRefusedBeforeTomlTakesItForNone) {
    for (const char* text : {"a = [}", "a = [1, }", "a =[[[[}}[[", "a = [ # [\n\t}\n]",
                             "a = ['x',\r\n}]", "[t]\na = [\n{b = [1,}]}\n]\n"})
        EXPECT_THROW(plain_toml("c.toml", text), Error) << text;
    for (const char* text : {"a = [{}]", "a = [{b = [1]}, {c = []}]", "a = ['[}', \",}\"] # [}\n",
                             "a = {b = [\n1,\n]}", "[t]\n} = 1"})
        EXPECT_NO_THROW(plain_toml("c.toml", text)) << text;
    EXPECT_NE(complaint("[example]\nname = [\n}\n").find("c.toml:3: expected a value"),
              std::string::npos);
}

TEST(Config, TomlSeesAsciiAloneWithTheSameLinesAndValues) {
    const auto plain = [](const char* text) { return plain_toml("c.toml", text); };
    for (const char* text :
         {"a = 'x'\n[b] # c\nd = \"\\u00e9\" \n", "a = '''\n'\n'''''", "a = '", "a = \""})
        EXPECT_EQ(plain(text), text);
    EXPECT_EQ(plain("a = \"\xc3\xa9\xf0\x9f\x8f\x96\" # \xc3\xa9\n"),
              "a = \"\\u00E9\\U0001F3D6\" # \\u00E9\n");
    EXPECT_EQ(plain("a = 'C:\\\xc3\xa9\"'\nb"), "a = \"C:\\\\\\u00E9\\\"\"\nb");
    EXPECT_EQ(plain("a = '''\n\xc3\xa9'''''\nb"), "a = \"\"\"\n\\u00E9''\"\"\"\nb");
    EXPECT_EQ(plain("a = '\xc3\xa9\nb"), "a = \"\\u00E9\nb");
    EXPECT_EQ(plain("a = \"\"\"\\\n\xef\xb3\xbf\"\"\""), "a = \"\"\"\\\n\\uFCFF\"\"\"");
    // Where toml++ sees no string but a word, and where it reads on behind a backslash.
    EXPECT_EQ(plain("a = 1C'\xef\xbb\xb0'"), "a = 1C\"\\uFEF0\"");
    for (const char* text :
         {"a = \"\"\"b\\\xef\xb3\xbf\"\"\"", "a = \"\\\xc3\xa9\"", "a = '\xff'", "a = \"\xc3\"",
          "# \xed\xa0\x80", "a = \"\xf4\x90\x80\x80\"", "'\xc0\x80'"})
        EXPECT_THROW(plain(text), Error) << text;
    EXPECT_EQ(complaint("[example]\nname = '\xc3\xa9\xef\xb8\x8f'\n"), "");
}

TEST(Config, AFileThatIsNotThereIsAnErrorAndAnEmptyOneIsNot) {
    EXPECT_THROW(read_config_file("/nowhere/c.toml"), Error);
    EXPECT_THROW(read_config_file("/tmp"), Error);
    EXPECT_EQ(complaint(""), "");
}

TEST(Config, PrintedItReadsBack) {
    Example example;
    example.name = "a \"quoted\" \\ name";
    example.out = {"x", "y"};
    SettingTable table = example.table();
    const TempFolder temp;
    for (const bool explain : {false, true}) {
        std::ostringstream text;
        print_config(text, {&table}, explain);
        test::write_text(temp / "c.toml", text.str());
        Example again;
        SettingTable other = again.table();
        resolve_settings(other, read_config_file(temp / "c.toml"), {});
        EXPECT_EQ(again.name, example.name);
        EXPECT_EQ(again.out, example.out);
    }
}

TEST(Config, VariablesThatMeanNothingAreFound) {
    Example example;
    const SettingTable table = example.table();
    const char* const environment[]{"PATH=/bin", "EVENTIDE_EXAMPLE_RATE=1",
                                    "EVENTIDE_EXAMPLE_RAET=1", "EVENTIDE_MODELS=x", nullptr};
    EXPECT_EQ(unknown_variables(environment, {&table}),
              std::vector<std::string>{"EVENTIDE_EXAMPLE_RAET"});
}

}  // namespace
}  // namespace eventide::app
