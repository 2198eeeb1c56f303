// Moments count from a recording's first event, or are the sensor's own.
#include "src/app/moment.h"
#include "src/core/error.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

namespace eventide::app {
namespace {

TEST(Moment, ReadsBack) {
    for (const char* text : {"0s", "20ms", "1500us", "@1633953690975951", "@-5"})
        EXPECT_EQ(show_moment(parse_moment(text)), text);
    EXPECT_THROW(parse_moment("@"), Error);
    EXPECT_THROW(parse_moment("@1.5"), Error);
    EXPECT_THROW(parse_moment("later"), Error);
}

TEST(Moment, CountsFromTheFirstEvent) {
    const test::TempFolder temp;
    test::write_text(temp / "e.txt", "8 8\n2.000001 1 1 1\n2.5 2 2 0\n");
    const MomentReader reader{temp / "e.txt", {}};
    EXPECT_EQ(to_us(reader.time_of(parse_moment("0s"))), 2'000'001);
    EXPECT_EQ(to_us(reader.time_of(parse_moment("0.25s"))), 2'250'001);
    EXPECT_EQ(to_us(reader.time_of(parse_moment("@7"))), 7);
}

TEST(Moment, OfStandardInputMustBeAbsolute) {
    const MomentReader reader{"-", {}};
    EXPECT_EQ(to_us(reader.time_of(parse_moment("@7"))), 7);
    EXPECT_THROW(reader.time_of(parse_moment("1s")), Error);
}

}  // namespace
}  // namespace eventide::app
