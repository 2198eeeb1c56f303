// In which unit the times of a text are: stated, or what gives a plausible rate of events.
#include "tests/codec/text_checks.h"

#include <cstdint>
#include <cstdio>
#include <string>

namespace eventide {
namespace {

TEST(Text, AStatedUnitThatNoStillSceneExplainsIsSaid) {
    std::string rows;
    for (int i = 0; i < 500; ++i) rows += std::to_string(50 * i) + " 1 2 1\n";
    const TextHeader seconds = read_text_header(to_bytes(rows), {.unit = TextTimeUnit::seconds});
    EXPECT_EQ(seconds.layout.unit, TextTimeUnit::seconds) << "as stated all the same";
    ASSERT_EQ(seconds.remarks.size(), 1U);
    EXPECT_NE(seconds.remarks[0].find("0.02 events/s, which is slow for a sensor; taken for "
                                      "microseconds they were 2e+04 events/s"),
              std::string::npos)
        << seconds.remarks[0];
    for (const TextTimeUnit unit :
         {TextTimeUnit::milliseconds, TextTimeUnit::microseconds, TextTimeUnit::nanoseconds})
        EXPECT_EQ(read_text_header(to_bytes(rows), {.unit = unit}).remarks.size(),
                  unit == TextTimeUnit::milliseconds ? 1U : 0U);
}

TEST(Text, AStatedUnitIsTakenAndAnImpossibleOneIsSaid) {
    std::string rows;
    for (int i = 0; i < 500; ++i) rows += std::to_string(5 + 1e-5 * i) + " 1 2 1\n";
    for (const TextTimeUnit unit : {TextTimeUnit::seconds, TextTimeUnit::milliseconds,
                                    TextTimeUnit::microseconds, TextTimeUnit::nanoseconds}) {
        const TextHeader header = read_text_header(to_bytes(rows), {.unit = unit});
        EXPECT_EQ(header.layout.unit, unit);
        EXPECT_EQ(header.remarks.empty(), unit <= TextTimeUnit::milliseconds);
    }
}

TEST(Text, TheUnitOfWholeNumbersFollowsFromTheirRate) {
    const auto header_of = [](std::int64_t first, std::int64_t step) {
        std::string text;
        for (int i = 0; i < 500; ++i) text += std::to_string(first + step * i) + " 1 2 1\n";
        return read_text_header(to_bytes(text), {});
    };
    struct Case {
        std::int64_t first, step;
        TextTimeUnit unit;
        bool is_said;
    };
    for (const Case& c : {Case{0, 10, TextTimeUnit::microseconds, false},
                          Case{1'600'000'000'000'000, 10, TextTimeUnit::microseconds, false},
                          Case{0, 500, TextTimeUnit::microseconds, true},
                          Case{0, 5'000, TextTimeUnit::microseconds, true},
                          Case{0, 20'000, TextTimeUnit::nanoseconds, true},
                          Case{1'600'000'000'000'000, 20'000, TextTimeUnit::microseconds, true},
                          Case{1'600'000'000'000'000'000, 500, TextTimeUnit::nanoseconds, true},
                          Case{0, 50'000'000'000, TextTimeUnit::microseconds, true}}) {
        const TextHeader header = header_of(c.first, c.step);
        EXPECT_EQ(header.layout.unit, c.unit) << c.first << " " << c.step;
        EXPECT_EQ(!header.remarks.empty(), c.is_said) << c.first << " " << c.step;
    }
    std::string of_ticks;  // microseconds of a sensor, in nanoseconds
    for (int i = 0; i < 500; ++i)
        of_ticks += std::to_string((5 * i + i * i % 3) * 1000) + " 1 2 1\n";
    EXPECT_EQ(read_text_header(to_bytes(of_ticks), {}).layout.unit, TextTimeUnit::nanoseconds);
    // A first time of another clock, which readers leave out, tells nothing either.
    std::string text = "0 1 2 1\n";
    for (int i = 0; i < 500; ++i)
        text += std::to_string(1'600'000'000'000'000 + 10 * i) + " 1 2 1\n";
    const TextHeader leap = read_text_header(to_bytes(text), {});
    EXPECT_EQ(leap.layout.unit, TextTimeUnit::microseconds);
    EXPECT_TRUE(leap.remarks.empty()) << leap.remarks.front();
    // numpy.savetxt() writes whole microseconds so.
    const auto written = [](const char* format, double step) {
        std::string rows;
        for (int i = 0; i < 500; ++i) {
            char row[64];
            std::snprintf(row, sizeof row, format, 5e6 + step * i);
            rows += row;
        }
        return read_text_header(to_bytes(rows), {});
    };
    for (const char* format : {"%.18e 1 2 1\n", "%.1f 1 2 1\n"}) {
        const TextHeader saved = written(format, 10);
        EXPECT_EQ(saved.layout.unit, TextTimeUnit::microseconds) << format;
        EXPECT_EQ(saved.remarks.size(), 1U) << format;
    }
    // Fractions are seconds; where sensors seldom send so few of them it is said.
    EXPECT_TRUE(written("%.6f 1 2 1\n", 1e-5).remarks.empty());
    const TextHeader slow = written("%.3f 1 2 1\n", .5);
    EXPECT_EQ(slow.layout.unit, TextTimeUnit::seconds);
    ASSERT_EQ(slow.remarks.size(), 1U);
    EXPECT_NE(slow.remarks.front().find("2 events/s, which is slow"), std::string::npos);
    // A few rows tell no rate.
    EXPECT_EQ(read_text_header(to_bytes("0 1 2 1\n20000 1 2 1\n"), {}).layout.unit,
              TextTimeUnit::microseconds);
}

}  // namespace
}  // namespace eventide
