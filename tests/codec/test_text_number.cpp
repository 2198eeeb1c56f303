// Decimal numbers must be exact to the microsecond.
#include "src/codec/text/text_number.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace eventide {
namespace {

std::optional<std::int64_t> microseconds(std::string_view seconds) {
    const auto value = parse_decimal(seconds);
    return value ? scaled_integer(*value, 6) : std::nullopt;
}

TEST(TextNumber, SecondsBecomeMicrosecondsExactly) {
    EXPECT_EQ(microseconds("0"), 0);
    EXPECT_EQ(microseconds("0.003811"), 3811);
    EXPECT_EQ(microseconds("2.713584"), 2713584);
    EXPECT_EQ(microseconds("1633953690.975950"), 1633953690975950);
    EXPECT_EQ(microseconds("1633953690.9759500000"), 1633953690975950);
    EXPECT_EQ(microseconds("-1.5"), -1500000);
    EXPECT_EQ(microseconds("+3"), 3000000);
    EXPECT_EQ(microseconds(".25"), 250000);
    EXPECT_EQ(microseconds("7."), 7000000);
    EXPECT_EQ(microseconds("3.811000000000000000e-03"), 3811);
    EXPECT_EQ(microseconds("1.633953690975950000e+09"), 1633953690975950);
    EXPECT_EQ(microseconds("1E3"), 1000000000);
}

TEST(TextNumber, HalvesAreRoundedAwayFromZero) {
    EXPECT_EQ(microseconds("0.0000005"), 1);
    EXPECT_EQ(microseconds("0.00000049999999999999999999999"), 0);
    EXPECT_EQ(microseconds("0.0000015"), 2);
    EXPECT_EQ(microseconds("-0.0000005"), -1);
    EXPECT_EQ(microseconds("1e-300"), 0);
}

TEST(TextNumber, NumbersAtTheirLimits) {
    const auto scaled = [](std::string_view text, int shift) {
        return scaled_integer(*parse_decimal(text), shift);
    };
    EXPECT_EQ(scaled("9223372036854775807", 0), INT64_MAX);
    EXPECT_EQ(scaled("9223372036854775808", 0), std::nullopt);
    EXPECT_EQ(scaled("92233720368547758.07", 2), INT64_MAX);
    EXPECT_EQ(scaled("12345678901234567890", -3), 12'345'678'901'234'568);  // twenty digits of ns
    EXPECT_EQ(scaled("9e-20", 0), 0);
    EXPECT_EQ(scaled("5e-1", 0), 1);
}

TEST(TextNumber, WhatIsNoNumberOrDoesNotFitIsRefused) {
    for (const char* text : {"", "-", ".", "e5", "1e", "1e+", "1.2.3", "1x", "0x10", "nan", "inf",
                             "1 ", "1e99999999999", "99999999999999999999", "1e30"})
        EXPECT_EQ(microseconds(text), std::nullopt) << text;
}

TEST(TextNumber, RandomMicrosecondsSurviveAnyWayOfWriting) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 20000; ++i) {
        const auto us = std::int64_t(random() >> (random() % 60 + 4)) / 1000;
        std::string decimals = std::to_string(us % 1000000);
        decimals.insert(0, 6 - decimals.size(), '0');
        const std::string text = std::to_string(us / 1000000) + "." + decimals;
        ASSERT_EQ(microseconds(text), us) << text;
        ASSERT_EQ(microseconds(text + "4999"), us) << text;
        ASSERT_EQ(microseconds(text + "5"), us + 1) << text;
        ASSERT_EQ(microseconds(std::to_string(us) + "e-6"), us);
    }
}

TEST(TextNumber, DigitsAreReadEightAtATime) {
    std::mt19937 random(2);
    for (int length = 0; length <= 8; ++length)
        for (int next = 0; next < 256; ++next) {
            if (next >= '0' && next <= '9') continue;
            std::string text;
            for (int i = 0; i < length; ++i) text += char('0' + random() % 10);
            const std::uint32_t value = text.empty() ? 0 : std::uint32_t(std::stoul(text));
            text += std::string(9, char(next));
            const DigitRun run = read_digits(text.data());
            ASSERT_EQ(run.length, length) << text;
            ASSERT_EQ(run.value, value) << text;
        }
}

}  // namespace
}  // namespace eventide
