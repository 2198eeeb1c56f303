// Moments count from a recording's first event, or are the sensor's own.
#include "apps/cli/settings/time_point.h"
#include "src/core/error.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

namespace eventide::app {
namespace {

TEST(TimePoint, ReadsBack) {
    for (const char* text : {"0s", "20ms", "1500us", "@1633953690975951", "@-5"})
        EXPECT_EQ(show_time_point(parse_time_point(text)), text);
    EXPECT_THROW(parse_time_point("@"), Error);
    EXPECT_THROW(parse_time_point("@1.5"), Error);
    EXPECT_THROW(parse_time_point("later"), Error);
}

/// Sums of two, and what is begun before one, are still times.
TEST(TimePoint, IsNoFurtherFromZeroThanTimesOfEventsAre) {
    for (const char* text : {"@1152921504606846976", "@-1152921504606846976"})
        EXPECT_EQ(show_time_point(parse_time_point(text)), text);
    for (const char* text : {"@1152921504606846977", "@-1152921504606846977",
                             "@9223372036854775807", "@-9223372036854775808"})
        EXPECT_THROW(parse_time_point(text), Error) << text;
}

TEST(TimePoint, CountsFromTheFirstEvent) {
    const test::TempFolder temp;
    test::write_text(temp / "e.txt", "8 8\n2.000001 1 1 1\n2.5 2 2 0\n");
    const TimePointReader reader{temp / "e.txt", {}};
    EXPECT_EQ(to_us(reader.time_of(parse_time_point("0s"))), 2'000'001);
    EXPECT_EQ(to_us(reader.time_of(parse_time_point("0.25s"))), 2'250'001);
    EXPECT_EQ(to_us(reader.time_of(parse_time_point("@7"))), 7);
}

TEST(TimePoint, OfStandardInputMustBeAbsolute) {
    const TimePointReader reader{"-", {}};
    EXPECT_EQ(to_us(reader.time_of(parse_time_point("@7"))), 7);
    EXPECT_THROW(reader.time_of(parse_time_point("1s")), Error);
}

/// What is read to find the first event would be missing afterwards.
TEST(TimePoint, OfANamedPipeMustBeAbsolute) {
    const test::TempFolder temp;
    ASSERT_EQ(mkfifo((temp / "pipe").c_str(), 0600), 0);
    const TimePointReader reader{temp / "pipe", {}};
    EXPECT_EQ(to_us(reader.time_of(parse_time_point("@7"))), 7);
    EXPECT_THROW(reader.time_of(parse_time_point("1s")), Error);
    EXPECT_TRUE(is_read_once(temp / "pipe"));
    EXPECT_TRUE(is_read_once("-"));
    EXPECT_FALSE(is_read_once(temp.path()));
    EXPECT_FALSE(is_read_once("nothing"));
}

}  // namespace
}  // namespace eventide::app
