// What a file or a command line says for a setting, and how what is wrong with it is said.
#include "src/core/error.h"
#include "src/settings/setting.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

enum class Colour { red, blue };

/// What one setting of each kind says to a file of one key.
class Settings : public testing::Test {
protected:
    std::string refusal(const Setting& setting, const std::string& toml) const {
        test::write_text(temp_ / "a.toml", toml);
        try {
            for (const SettingValue& value : read_settings_file(temp_ / "a.toml").items)
                setting.set(value);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            const std::string text = error.what();
            return text.substr(std::min(text.find("a.toml"), text.size()));
        }
        return "taken";
    }

    test::TempFolder temp_;
    int whole_ = 1;
    bool flag_ = false;
    Colour colour_ = Colour::red;
    Setting whole_setting_ = whole_setting("n", whole_, 0, 9);
    Setting flag_setting_ = flag_setting("n", flag_);
    Setting colour_setting_ =
        choice_setting("n", colour_, "", {{Colour::red, "red"}, {Colour::blue, "blue"}});
};

TEST_F(Settings, OfAFileAreTakenAsTheyAreWritten) {
    EXPECT_EQ(refusal(whole_setting_, "n = 7"), "taken");
    EXPECT_EQ(refusal(flag_setting_, "n = true"), "taken");
    EXPECT_EQ(refusal(colour_setting_, "n = 'blue'"), "taken");
    EXPECT_EQ(whole_, 7);
    EXPECT_TRUE(flag_);
    EXPECT_EQ(colour_, Colour::blue);
}

TEST_F(Settings, OfAFileAreRefusedWithLineNameAndWhatStandsThere) {
    EXPECT_EQ(refusal(whole_setting_, "\nn = 10"),
              "a.toml:2: n: expected a whole number from 0 to 9, found 10");
    EXPECT_EQ(refusal(whole_setting_, "n = '7'"),
              "a.toml:1: n: expected a whole number from 0 to 9, found '7'");
    EXPECT_EQ(refusal(whole_setting_, "n = [1, 2]"),
              "a.toml:1: n: expected a whole number from 0 to 9, found a list of 2");
    EXPECT_EQ(refusal(whole_setting_, "n = 2026-01-01"),
              "a.toml:1: n: expected a whole number from 0 to 9, found a date or time of day");
    EXPECT_EQ(refusal(flag_setting_, "n = 1"), "a.toml:1: n: expected true or false, found 1");
    EXPECT_EQ(refusal(flag_setting_, "n = 'true'"),
              "a.toml:1: n: expected true or false, found 'true'");
    EXPECT_EQ(refusal(colour_setting_, "n = 'green'"),
              "a.toml:1: n: expected \"red\" or \"blue\", found 'green'");
    EXPECT_EQ(refusal(colour_setting_, "n = {}"),
              "a.toml:1: n: expected \"red\" or \"blue\", found a table");
    EXPECT_EQ((std::pair{whole_, colour_}), (std::pair{1, Colour::red})) << "nothing was taken";
}

TEST_F(Settings, OfAnEndlessValueOnlyTheBeginningIsShown) {
    EXPECT_LT(refusal(colour_setting_, "n = '" + std::string(1 << 20, 'x') + "'").size(), 300U);
}

TEST_F(Settings, ItemsOfListsAndTablesHaveLinesOfTheirOwn) {
    const Setting each = file_setting("n", [](const SettingValue& value) {
        for (const SettingValue& item : value.items) whole_of(item, 0, 9);
    });
    EXPECT_EQ(refusal(each, "n = [\n1,\n-1]"),
              "a.toml:3: n: expected a whole number from 0 to 9, found -1");
    EXPECT_EQ(refusal(each, "[n]\na = 1\nb = 99"),
              "a.toml:3: n.b: expected a whole number from 0 to 9, found 99");
}

TEST_F(Settings, OfACommandLineAreWordsInQuotes) {
    const auto words = [](const Setting& setting, const std::string& text) -> std::string {
        try {
            set_from("--n", setting, text);
        } catch (const Error& error) {
            return error.what();
        }
        return "taken";
    };
    EXPECT_EQ(words(whole_setting_, "7"), "taken");
    EXPECT_EQ(words(whole_setting_, "10"), "--n: expected a whole number from 0 to 9, found '10'");
    EXPECT_EQ(words(flag_setting_, "yes"), "--n: expected true or false, found 'yes'");
    EXPECT_EQ(words(colour_setting_, "green"), "--n: expected red or blue, found 'green'");
}

}  // namespace
}  // namespace eventide
