// What a terminal would obey is shown instead.
#include "apps/cli/printable.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace eventide::app {
namespace {

TEST(Printable, TextForPeopleStaysAsItIs) {
    for (const char* text : {"", "DAVIS346, serial 00000042", "Grüße 日本 🎥", "a\\b \"c\""})
        EXPECT_EQ(printable(text), text);
}

TEST(Printable, WhatATerminalObeysIsShown) {
    EXPECT_EQ(printable("a\x1b[2Jb\a\x7f\r\n\t"), "a\\x1b[2Jb\\x07\\x7f\\x0d\\x0a\\x09");
    EXPECT_EQ(printable(std::string_view("\0", 1)), "\\x00");
    EXPECT_EQ(printable("one\n\ttwo\r", Lines::keep), "one\n\ttwo\\x0d");
    // C1 as UTF-8 (CSI) and as a bare byte, which old terminals obey.
    EXPECT_EQ(printable("\xc2\x9b"
                        "2J \x9b"
                        "2J"),
              "\\u009b2J \\x9b2J");
}

TEST(Printable, DirectionMarksAndWhatHasNoWidthAreShown) {
    EXPECT_EQ(printable("\u202egpj.exe\u202c \u2066x\u2069 \u200f\u061c"),
              "\\u202egpj.exe\\u202c \\u2066x\\u2069 \\u200f\\u061c");
    EXPECT_EQ(printable("a\u200bb\ufeff\u2028"), "a\\u200bb\\ufeff\\u2028");
}

TEST(Printable, BytesThatAreNoUtf8AreShownOneByOne) {
    EXPECT_EQ(printable("\xff\xc0\x80\xed\xa0\x80\xf5"), "\\xff\\xc0\\x80\\xed\\xa0\\x80\\xf5");
    EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");                    // cut short
    EXPECT_EQ(printable("\xf0\x82\x82\xac"), "\\xf0\\x82\\x82\\xac");  // longer than needed
}

TEST(Printable, JsonIsAsciiWhateverItHolds) {
    EXPECT_EQ(json_text({{"a", "\x1b\u202e\xff"}}, -1), "{\"a\":\"\\u001b\\u202e\\ufffd\"}");
}

}  // namespace
}  // namespace eventide::app
