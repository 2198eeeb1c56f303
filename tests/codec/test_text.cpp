// Text recordings: rows read, damage counted, and back again.
#include "tests/codec/text_checks.h"

#include <random>
#include <string>

namespace eventide {
namespace {

constexpr int kWidth = kTextWidth, kHeight = kTextHeight;

MakeParser default_parser(TextTimeUnit unit = TextTimeUnit::seconds) {
    return [=] {
        TextLayout layout;
        layout.unit = unit;
        return std::make_unique<TextParser>(layout, kWidth, kHeight);
    };
}

TEST(Text, EpochTimesStayExact) {
    const Parsed parsed = parse_text("1633953690.975950 1 2 1\n1633953690.975951 1 2 1\n");
    ASSERT_EQ(parsed.data.events.size(), 2U);
    EXPECT_EQ(to_us(parsed.data.events[0].t), 1633953690975950);
    EXPECT_EQ(to_us(parsed.data.events[1].t), 1633953690975951);
}

TEST(Text, DamageIsCountedByReasonAndReadingGoesOn) {
    std::string text = "0.1 1 2 1\n";
    text += "0.2 1 2\n";                        // bad_record
    text += "0.3 1 2 5\n";                      // bad_record
    text += "0.4 1.5 2 1\n";                    // bad_record
    text += "0.5 240 2 1\n";                    // out_of_range
    text += "0.6 -1 2 1\n";                     // out_of_range
    text += "0.05 1 2 1\n";                     // time_backwards
    text += std::string(5000, '1') + "\n";      // bad_length
    text += "99999999999999999999 1 2 1\n";     // bad_record
    text += "0.6 4444444444444444441.0 1 1\n";  // out_of_range
    text += "0.7 239 179 0\n";
    text += "0.8 1";  // truncated
    const Parsed parsed = parse_text(text);
    EXPECT_EQ(parsed.data.events.size(), 2U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 4U);
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 3U);
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_length], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U);
    EXPECT_EQ(parsed.clock, from_us(700000));
}

TEST(Text, ALoneLeapIsDamageAndAPauseIsNot) {
    const Parsed leap = parse_text("0.1 1 1 1\n900000.0 1 1 1\n0.2 1 1 1\n0.3 1 1 1\n");
    EXPECT_EQ(leap.data.events.size(), 3U);
    EXPECT_EQ(leap.damage[DamageReason::bad_record], 1U);
    const Parsed pause = parse_text("0.1 1 1 1\n0.1 2 1 1\n900000.0 1 1 1\n900000.1 1 1 1\n");
    EXPECT_EQ(pause.data.events.size(), 4U);
    EXPECT_EQ(pause.damage.total(), 0U);
    EXPECT_EQ(parse_text("0.1 1 1 1\n900000.0 1 1 1\n").data.events.size(), 2U);
}

TEST(Text, AFirstTimeThatNoneOfTheNextAgreesWithIsDamage) {
    const auto expect_two = [](const std::string& text) {
        const Parsed parsed = parse_text(text);
        ASSERT_EQ(parsed.data.events.size(), 2U) << text;
        EXPECT_EQ(parsed.data.events[0].t, from_us(1'633'953'690'000'000)) << text;
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U) << text;
    };
    const std::string agreeing = "1633953690.0 1 1 1\n1633953690.1 1 1 1\n";
    expect_two("0 5 5 1\n" + agreeing);
    expect_two("9e12 5 5 1\n" + agreeing);
    // Events that agree are kept, however long the pause; so is a first one before a short pause.
    for (const char* text : {"0 1 1 1\n0.1 1 1 1\n1633953690 1 1 1\n1633953691 1 1 1\n",
                             "0 1 1 1\n50 1 1 1\n50.1 1 1 1\n", "0 1 1 1\n1633953690 1 1 1\n"})
        EXPECT_EQ(parse_text(text).damage.total(), 0U) << text;
}

TEST(Text, RowsALittleOutOfOrderAreSortedAndLaterOnesAreCounted) {
    std::mt19937 random(1);
    std::string text;
    for (int i = 0; i < 20'000; ++i)  // up to 9 ms before the newest
        text += std::to_string(1'000'000 + 10 * i - int(random() % 9000)) + " 1 2 1\n";
    TextOptions microseconds;
    microseconds.unit = TextTimeUnit::microseconds;
    const Parsed sorted = parse_text(text, microseconds);
    EXPECT_EQ(sorted.data.events.size(), 20'000U);
    EXPECT_EQ(sorted.damage.total(), 0U);
    expect_orderly(sorted, kWidth, kHeight);
    microseconds.reorder = SensorDuration{0};
    EXPECT_GT(parse_text(text, microseconds).damage[DamageReason::time_backwards], 15'000U);
    const Parsed late =
        parse_text("0.08 1 1 1\n0.1 1 1 1\n0.101 1 1 1\n0.05 1 1 1\n0.0995 1 1 1\n");
    EXPECT_EQ(late.data.events.size(), 4U);
    EXPECT_EQ(late.damage[DamageReason::time_backwards], 1U);
}

std::string random_text(unsigned seed, std::size_t n) {
    Batch batch;
    batch.events = random_events(seed, n, kWidth, kHeight, 999'990);
    Bytes bytes;
    TextWriter().write(batch, bytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(Text, AnySplitGivesTheSame) {
    expect_same_for_any_split(default_parser(), to_bytes(random_text(1, 500)));
    expect_same_for_any_split(
        default_parser(), to_bytes(random_text(2, 20) + "junk\n# c\n" + std::string(3000, 'x') +
                                   "\n" + std::string(1024, ' ') + "\n" + std::string(1025, ' ') +
                                   "\n" + random_text(3, 20) + std::string(2000, '7')));
}

TEST(Text, AnyCutGivesABeginning) {
    expect_beginnings_for_any_cut(default_parser(), to_bytes(random_text(4, 30)));
}

TEST(Text, DamageAnywhereIsBorne) {
    expect_bears_damage(default_parser(), to_bytes(random_text(5, 100)), kWidth, kHeight);
}

/// The same rows, padded so that only the careful way reads them.
TEST(Text, TheQuickWayAndTheCarefulWayAgree) {
    const std::string quick = random_text(6, 2000);
    std::string careful;
    for (const char c : quick) careful += c == '\n' ? std::string(" \n") : std::string(1, c);
    for (std::size_t i = 0; i < careful.size(); ++i)
        if (i == 0 || careful[i - 1] == '\n') careful.insert(i++, " ");
    const Parsed a = parse_whole(default_parser(), to_bytes(quick));
    const Parsed b = parse_whole(default_parser(), to_bytes(careful));
    EXPECT_EQ(a.data.events.size(), 2000U);
    expect_same(a, b, "padded");
}

struct Unit {
    TextTimeUnit unit;
    int decimals;  ///< of a microsecond; negative: whole numbers have so many digits more
};

/// Rows as programs write them, and as none should.
std::string odd_rows(unsigned seed, const Unit& unit) {
    std::mt19937 random(seed);
    const auto pick = [&](const std::vector<std::string>& all) {
        return all[random() % all.size()];
    };
    std::string text;
    for (std::uint64_t t = 0; t < 3'000'000; t += random() % 3'000) {
        std::string time = std::to_string(t);
        for (int i = unit.decimals; i < 0; ++i) time += char('0' + random() % 10);
        if (unit.decimals >= 0) {
            time.insert(0, std::size_t(unit.decimals), '0');
            time.insert(time.size() - std::size_t(unit.decimals), ".");
            for (unsigned more = unsigned(random() % 5); more > 0; --more)
                time += char('0' + random() % 10);
        }
        const std::string between = pick({" ", ",", "\t", ";", "  ", "     ", ", "});
        const bool odd = random() % 5 == 0;
        const auto place = [&] {
            return odd ? pick({"5.0", "5.5", "-1", "+3", "1e1", "240", "180", "x", "", "007"})
                       : std::to_string(random() % 180);
        };
        text += time + between + place() + between + place() + between +
                (odd ? pick({"1.0", "2", "-1", "on", "0"}) : std::to_string(random() % 2)) +
                pick({"\n", "\r\n", " 7\n"});
    }
    return text;
}

TEST(Text, OddRowsAreTheSameBothWaysInEveryUnit) {
    for (const Unit& unit :
         {Unit{TextTimeUnit::seconds, 6}, Unit{TextTimeUnit::milliseconds, 3},
          Unit{TextTimeUnit::microseconds, 0}, Unit{TextTimeUnit::nanoseconds, -3}}) {
        const std::string quick = odd_rows(1, unit);
        std::string careful = " ";
        for (const char c : quick) careful += c == '\n' ? "\n " : std::string(1, c);
        const Parsed a = parse_whole(default_parser(unit.unit), to_bytes(quick)),
                     b = parse_whole(default_parser(unit.unit), to_bytes(careful));
        EXPECT_GT(a.data.events.size(), 1'500U);
        EXPECT_GT(a.damage.total(), 100U);
        expect_same(a, b, "in unit " + std::to_string(int(unit.unit)));
    }
}

TEST(Text, OtherPolaritiesAreTheSameBothWays) {
    std::string quick, careful;
    for (int i = 0; i < 1500; ++i) {
        const char* const polarities[] = {" 255", " 0", " 1", " -1", " -255", " -0", " on"};
        const std::string row =
            std::to_string(100 + i) + " 7 2" + polarities[i < 1000 ? i % 2 : i % 7];
        quick += row + "\n";
        careful += " " + row + " \n";
    }
    const Parsed a = parse_text(quick), b = parse_text(careful);
    EXPECT_GT(a.data.events.size(), 1000U);
    expect_same(a, b, "padded");
    // 1, -1 and -255 are none where 255 is on; -0 is 0.
    std::uint64_t none = 0;
    for (int i = 1000; i < 1500; ++i) none += std::uint64_t(i % 7 >= 2 && i % 7 <= 4);
    EXPECT_EQ(a.damage[DamageReason::bad_record], none);
}

TEST(Text, ARowThatIsShorterThanTheHeaderRowIsDamage) {
    const Parsed parsed = parse_text("t,id,x,y,p\n0.1,9,1,2,1\n0.2,1,2,1\n0.3,9,3,4,0\n");
    EXPECT_EQ(parsed.data.events.size(), 2U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
}

TEST(Text, WhatIsWrittenIsReadBack) {
    for (const std::int64_t first :
         {std::int64_t(0), std::int64_t(-5'000'000), std::int64_t(1'633'953'690'975'950)}) {
        Batch batch;
        batch.events = random_events(7, 3000, 1280, 720, first, 2000);
        StreamHeader header;
        header.width = 1280;
        header.height = 720;
        Bytes bytes;
        TextWriter writer(first == 0 ? TextSize::in_a_comment : TextSize::in_a_line);
        writer.begin(header, bytes);
        writer.write(batch, bytes);
        writer.finish(bytes);
        const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        EXPECT_EQ(read_text_header(bytes, {}).stream.width, 1280);
        const Parsed parsed = parse_text(text, {}, 1280, 720);
        EXPECT_TRUE(parsed.data.events == batch.events);
        EXPECT_EQ(parsed.damage.total(), 0U);
    }
}

TEST(Text, AfterAJumpReadingGoesOnAtTheNextLine) {
    const auto parser = default_parser()();
    Batch batch;
    parser->parse(to_bytes("5.000000 1 2 1\n5.1 3"), batch);
    parser->resync();
    EXPECT_EQ(parser->clock(), std::nullopt);
    parser->parse(to_bytes("17 20 1\n0.5 7 8 0\n"), batch);
    parser->finish(batch);
    ASSERT_EQ(batch.events.size(), 2U);
    EXPECT_EQ(batch.events[1], (Event{from_us(500000), 7, 8, Polarity::off}));
    EXPECT_EQ(parser->damaged().total(), 0U);
}

}  // namespace
}  // namespace eventide
