// Text into values, and what is said when it is none.
#include "src/core/error.h"
#include "src/settings/values.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

TEST(Values, TimesAreExactToTheMicrosecond) {
    EXPECT_EQ(parse_duration("1.5s").count(), 1'500'000);
    EXPECT_EQ(parse_duration("0.000001s").count(), 1);
    EXPECT_EQ(parse_duration("20ms").count(), 20'000);
    EXPECT_EQ(parse_duration("250us").count(), 250);
    EXPECT_EQ(parse_duration("-1s", true).count(), -1'000'000);
}

TEST(Values, TimesReadBack) {
    for (const std::int64_t us : {0LL, 1LL, 999LL, 1000LL, 1'500'000LL, 60'000'000LL})
        EXPECT_EQ(parse_duration(show_duration(SensorDuration{us})).count(), us);
}

TEST(Values, ATimeWithoutAUnitIsRefusedWithTheWaysToWriteIt) {
    for (const std::string bare : {"1", "0", "50", "0.5"}) try {
            parse_duration(bare);
            ADD_FAILURE() << "took " << bare;
        } catch (const Error& error) {
            EXPECT_EQ(error.what(), "expected a time with its unit, " + bare + "s, " + bare +
                                        "ms or " + bare + "us, found '" + bare + "'");
        }
}

TEST(Values, NumbersReadBack) {
    for (const double n : {0.1, 1e-9, 1.0 / 3, 2.5, 123456789.0, 1e300})
        EXPECT_EQ(parse_number(show_number(n), 0, 1e300), n);
}

TEST(Values, NumbersAreWrittenInDigitsWhereThatIsShort) {
    EXPECT_EQ(show_number(100'000), "100000");
    EXPECT_EQ(show_number(1e-5), "0.00001");
    EXPECT_EQ(show_number(1e300), "1e+300");
}

TEST(Values, SizesReadBack) {
    EXPECT_EQ(parse_size("640x480"), (Size{640, 480}));
    EXPECT_EQ(show_size(parse_size("1x2")), "1x2");
    EXPECT_EQ(parse_size("16384x16384"), (Size{16384, 16384}));
}

TEST(Values, SayWhatWasExpectedAndFound) {
    const auto message = [](auto parse) -> std::string {
        try {
            parse();
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::usage);
            return error.what();
        }
        return "no error";
    };
    for (const char* wrong : {"", "x", "1 s", "1e400", "nan", "-1s", "5min", "1s2"})
        EXPECT_NE(message([&] { parse_duration(wrong); }).find("expected a time"),
                  std::string::npos)
            << wrong;
    for (const char* wrong : {"", "640", "640x", "x480", "0x5", "640X480", "-1x5", "99999x5"})
        EXPECT_NE(message([&] { parse_size(wrong); }).find("expected a size"), std::string::npos)
            << wrong;
    for (const char* wrong : {"", "3.5", "4", "-1", "1a", "99999999999"})
        EXPECT_EQ(message([&] { parse_whole(wrong, 0, 3); }),
                  std::string{"expected a whole number from 0 to 3, found '"} + wrong + "'");
    EXPECT_LT(message([&] { parse_duration(std::string(1 << 20, 'x')); }).size(), 300U)
        << "a file may have a value without an end";
    EXPECT_EQ(message([&] {
                  parse_choice("c", {"a", "b", "d"});
              }),
              "expected a, b or d, found 'c'");
    EXPECT_EQ(message([&] { parse_number("nan", 0, 1); }),
              "expected a number from 0 to 1, found 'nan'");
}

}  // namespace
}  // namespace eventide
