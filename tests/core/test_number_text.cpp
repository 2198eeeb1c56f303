// Numbers from text: whole or at the front, and nothing else.
#include "src/core/number_text.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace eventide {
namespace {

TEST(NumberText, TheWholeTextIsANumberOrNothingIs) {
    EXPECT_EQ(number_in<int>("-12"), -12);
    EXPECT_EQ(number_in<double>("1e3"), 1000);
    for (const char* text : {"", " 1", "1 ", "+1", "1x", "x", "-", "99999999999", "1.5"})
        EXPECT_EQ(number_in<int>(text), std::nullopt) << text;
    EXPECT_EQ(number_in<std::uint64_t>("-1"), std::nullopt);
    EXPECT_EQ(number_in<std::uint64_t>("18446744073709551615"), UINT64_MAX);
}

TEST(NumberText, FloatingPointNumbersAreFinite) {
    for (const char* text : {"inf", "-inf", "nan", "1e999", "infinity"})
        EXPECT_EQ(number_in<double>(text), std::nullopt) << text;
}

TEST(NumberText, ANumberAtTheFrontIsTakenOff) {
    std::string_view text = "20ms";
    EXPECT_EQ(take_number<double>(text), 20);
    EXPECT_EQ(text, "ms");
    EXPECT_EQ(take_number<double>(text), std::nullopt);
    EXPECT_EQ(text, "ms");
}

TEST(NumberText, ASizeIsTwoNumbersWithACross) {
    EXPECT_EQ(size_in("640x480"), (std::pair{640, 480}));
    for (const char* text : {"640", "640x", "x480", "640X480", "640x480 ", "640x480x3", "6 x4"})
        EXPECT_EQ(size_in(text), std::nullopt) << text;
}

}  // namespace
}  // namespace eventide
