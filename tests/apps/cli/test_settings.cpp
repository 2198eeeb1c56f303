// Every setting of every command: what it shows it reads back, and its names are its own.
#include "apps/cli/program.h"
#include "apps/cli/settings/config.h"
#include "src/core/error.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <set>

namespace eventide::app {
namespace {

TEST(Settings, ReadBackWhatTheyShow) {
    for (const auto& command : all_commands())
        for (Setting& setting : command->settings().settings) {
            const auto shown = setting.show();
            if (shown.empty()) continue;
            ASSERT_NO_THROW(setting.set(shown)) << command->name() << " " << setting.key;
            EXPECT_EQ(setting.show(), shown) << command->name() << " " << setting.key;
        }
}

/// What setting this text throws; empty where it is taken.
std::string complaint(Setting& setting, const std::string& text) {
    try {
        setting.set({text});
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(Settings, EveryTimeIsWrittenWithItsUnit) {
    std::set<std::string> times;
    for (const auto& command : all_commands())
        for (Setting& setting : command->settings().settings) {
            if (setting.value_name != "TIME" && setting.value_name != "WINDOW") continue;
            const std::string name = command->name() + " " + flag_of(setting);
            times.insert(name);
            for (const char* text : {"50s", "50ms", "50us"})
                EXPECT_EQ(complaint(setting, text), "") << name;
            EXPECT_NE(complaint(setting, "50").find("50s, 50ms"), std::string::npos)
                << name << ": " << complaint(setting, "50");
        }
    for (const char* known :
         {"run --from", "run --to", "run --warmup", "run --latency", "run --duration",
          "run --window", "run --reorder", "info --reorder", "convert --from", "convert --to",
          "convert --reorder", "evaluate --from", "evaluate --to", "evaluate --window"})
        EXPECT_TRUE(times.contains(known)) << known;
}

/// They are what a shell completes, too.
TEST(Settings, NameAutoAmongTheirWordsWhereItIsTaken) {
    for (const auto& command : all_commands())
        for (Setting& setting : command->settings().settings) {
            const std::string& words = setting.value_name;
            if (words.find('|') == words.npos || words.find("FILE") != words.npos) continue;
            EXPECT_EQ(complaint(setting, "auto").empty(), words.find("auto") != words.npos)
                << command->name() << " " << flag_of(setting) << " " << words;
        }
}

TEST(Settings, HelpTellsEveryValueOfAList) {
    std::vector<std::string> sizes{"240x180", "640x480"}, none;
    EXPECT_EQ(help_with_default(list_setting("sizes", sizes, "WxH", "Sizes.")),
              "Sizes. [240x180 640x480]");
    EXPECT_EQ(help_with_default(list_setting("sizes", none, "WxH", "Sizes.")), "Sizes.");
}

TEST(Settings, HaveOneNameEachAndAMeaning) {
    for (const auto& command : all_commands()) {
        std::set<std::string> keys;
        for (const Setting& setting : command->settings().settings) {
            EXPECT_TRUE(keys.insert(setting.key).second) << setting.key;
            EXPECT_GE(setting.help.size(), 7U) << setting.key;
            EXPECT_EQ(setting.kind == ValueKind::flag, setting.value_name.empty()) << setting.key;
            EXPECT_EQ(setting.key.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"),
                      std::string::npos);
        }
    }
}

TEST(Settings, DefaultTomlIsWhatTheCodeSays) {
    EXPECT_EQ(test::read_text(EVENTIDE_SOURCE_DIR "/config/default.toml"), default_config())
        << "config/default.toml is made by: eventide --default-config > config/default.toml";
}

TEST(Settings, DefaultTomlIsAConfigurationFile) {
    const ConfigFile file = read_config_file(EVENTIDE_SOURCE_DIR "/config/default.toml");
    for (const auto& command : all_commands()) {
        SettingTable table = command->settings();
        const auto before = command->settings();
        resolve_settings(table, file, {});
        for (std::size_t i = 0; i < table.settings.size(); ++i) {
            EXPECT_EQ(table.settings[i].show(), before.settings[i].show());
            EXPECT_TRUE(table.settings[i].origin.starts_with("file ")) << table.settings[i].key;
        }
    }
}

TEST(Settings, CommandsHaveExamplesThatNameThem) {
    for (const auto& command : all_commands())
        EXPECT_NE(command->examples().find("eventide " + command->name()), std::string::npos);
}

}  // namespace
}  // namespace eventide::app
