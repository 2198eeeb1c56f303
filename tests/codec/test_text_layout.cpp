// What a text says of itself, and what is guessed: size, order of columns, polarities.
#include "src/codec/text/text_row.h"
#include "src/core/error.h"
#include "tests/codec/text_checks.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {
namespace {

const std::vector<Event> kTwo{{from_us(3811), 96, 133, Polarity::off},
                              {from_us(1003820), 127, 171, Polarity::on}};

TEST(Text, TheSameEventsInEveryLayout) {
    for (const char* text : {
             "0.003811 96 133 0\n1.003820 127 171 1\n",
             "0.003811,96,133,0\n1.003820,127,171,1\n",
             "0.003811;96;133;0\n1.003820;127;171;1\n",
             "0.003811\t96\t133\t0\n1.003820\t127\t171\t1\n",
             "  0.003811  96   133 0  \r\n\r\n1.003820 127 171 1",
             "# a comment\n0.003811 96 133 -1\n# another\n1.003820 127 171 1\n",
             "0.003811, 96, 133, False\n1.003820, 127, 171, True\n",
             "3811 96 133 0\n1003820 127 171 1\n",
             "240 180\n3811 96 133 0\n1003820 127 171 1\n",
             "t,x,y,p\n0.003811,96,133,0\n1.003820,127,171,1\n",
             "x,y,timestamp,polarity\n96,133,0.003811,0\n127,171,1.003820,1\n",
             "x y p t_us\n96 133 0 3811\n127 171 1 1003820\n",
             "time_ns,y,x,pol,index\n3811000,133,96,0,5\n1003820000,171,127,1,6\n",
             "t [us],x,y,p\n3811,96,133,0\n1003820,127,171,1\n",
             "time (us) x y p\n3811 96 133 0\n1003820 127 171 1\n",
             "x, y, timestamp (ms), polarity\n96, 133, 3.811, 0\n127, 171, 1003.820, 1\n",
             "0.003811,96,133,OFF\n1.003820,127,171,On\n",
             "3811 96 133 f\n1003820 127 171 t\n",
             "96 133 0.003811 0\n127 171 1.003820 1\n",
             "0.003811 0 96 133\n1.003820 1 127 171\n",
             "0 96 133 0.003811\n1 127 171 1.003820\n",
             "3811 -1 96 133\n1003820 1 127 171\n",
             "0,96,133,3811\n1,127,171,1003820\n",
             "3811 96 133 0\n1003820 127 171 255\n",
             "96 133 1 0.003811\n127 171 2 1.003820\n",
             "96 133 0 0.003811\n127 171 1 1.003820\n",
             "96,133,0,3811\n127,171,1,1003820\n",
             "96,133,3811,0\n127,171,1003820,1\n",
             "96,133,False,3811\n127,171,True,1003820\n",
             "3.811e-03 9.6e+01 1.33e+02 0e+00\n1.003820e+00 1.27e+02 1.71e+02 1e+00\n",
             "0.0038105 96 133 0\n1.0038204999 127 171 1\n",
             "\xEF\xBB\xBF"
             "0.003811 96 133 0\n1.003820 127 171 1\n",
         }) {
        const Parsed parsed = parse_text(text);
        EXPECT_EQ(parsed.data.events, kTwo) << text;
        EXPECT_EQ(parsed.damage.total(), 0U) << text;
    }
}

TEST(Text, StatedLayoutsAreFollowed) {
    EXPECT_EQ(parse_text("96 133 0 3811\n127 171 1 1003820\n", {"xypt", {}}).data.events, kTwo);
    EXPECT_EQ(parse_text("3.811 96 133 0\n1003.820 127 171 1\n", {"", TextTimeUnit::milliseconds})
                  .data.events,
              kTwo);
    EXPECT_EQ(
        parse_text("3811000 96 133 0\n1003820000 127 171 1\n", {"", TextTimeUnit::nanoseconds})
            .data.events,
        kTwo);
    EXPECT_EQ(parse_text("0 96 133 0\n1 127 171 1\n", {"", TextTimeUnit::seconds}).data.events[1].t,
              from_us(1000000));
    EXPECT_THROW(parse_text("0 96 133 0\n", {"txyy", {}}), Error);
}

TEST(Text, TheSizeLineIsRead) {
    const TextHeader header = read_text_header(to_bytes("346 260\n0.1 1 2 1\n"), {});
    EXPECT_EQ(header.stream.width, 346);
    EXPECT_EQ(header.stream.height, 260);
    EXPECT_EQ(header.stream.data_offset, 8U);
    EXPECT_EQ(header.layout.unit, TextTimeUnit::seconds);
}

TEST(Text, ACommentMaySayTheSize) {
    for (const char* text :
         {"%geometry:346,260\n0.1 1 2 1\n", "# c\n# geometry: 346, 260\n0.1 1 2 1\n",
          "% date 1 1\n%geometry:346,260\n%end\nt,x,y,p\n0.1,1,2,1\n",
          "%geometry:9,9\n346 260\n0.1 1 2 1\n", "# geometry: 346,260\n"}) {
        EXPECT_TRUE(looks_like_text(to_bytes(text))) << text;
        const TextHeader header = read_text_header(to_bytes(text), {});
        EXPECT_EQ(header.stream.width, 346) << text;
        EXPECT_EQ(header.stream.height, 260) << text;
    }
    EXPECT_EQ(read_text_header(to_bytes("# 346 260\n0.1 1 2 1\n"), {}).stream.width, 0);
    EXPECT_THROW(read_text_header(to_bytes("%geometry:0,260\n0.1 1 2 1\n"), {}), Error);
}

TEST(Text, WithoutARowTheSizeOrTheColumnsAreEnough) {
    for (const char* text : {"346 260\n", "346 260", "# c\n346 260\n# c\n", "t,x,y,p\n"}) {
        const Parsed parsed = parse_text(text);
        EXPECT_TRUE(parsed.data.empty()) << text;
        EXPECT_EQ(parsed.damage.total(), 0U) << text;
    }
    EXPECT_EQ(read_text_header(to_bytes("346 260\n"), {}).stream.height, 260);
    EXPECT_THROW(read_text_header(to_bytes("# c\n"), {}), Error);
}

TEST(Text, WholeNumbersAreTakenInTheOrderThatMakesMostEvents) {
    // Times too small to stand out: that they never fall tells.
    const Parsed parsed = parse_text("90,3,1,7\n20,9,0,8\n50,1,1,9\n");
    ASSERT_EQ(parsed.data.events.size(), 3U);
    EXPECT_EQ(parsed.data.events[2], (Event{from_us(9), 50, 1, Polarity::on}));
    // A damaged row does not overrule the others.
    EXPECT_EQ(parse_text("90,3,1,70000\n20,9,0,80000\n1,1,7,1\n50,1,1,90000\n").data.events.size(),
              3U);
}

/// Events that a sensor sends in 20 ms, in rows that a hash table, say, put in any order.
std::vector<TextRow> rows_in_no_order() {
    std::vector<TextRow> rows;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        const std::uint32_t k = (i * 603) % 1000;
        rows.push_back({20 * std::int64_t(k), (k * 7919) % 240, (k * 104729) % 180, k % 2 == 1});
    }
    return rows;
}

std::string text_of(const std::vector<TextRow>& rows, std::string_view order) {
    std::string text;
    for (const TextRow& row : rows)
        for (const char column : order)
            text += std::to_string(column == 't'   ? row.t_us
                                   : column == 'x' ? row.x
                                   : column == 'y' ? row.y
                                                   : std::int64_t(row.on)) +
                    (column == order.back() ? "\n" : " ");
    return text;
}

TEST(Text, RowsInNoOrderOfTimeKeepTheirColumns) {
    const TextOptions in_a_second{.reorder = std::chrono::seconds(1)};
    for (const char* size : {"", "240 180\n"})
        for (const char* order : {"txyp", "xytp", "xypt", "tpxy", "pxyt"}) {
            const Parsed parsed =
                parse_text(size + text_of(rows_in_no_order(), order), in_a_second);
            EXPECT_EQ(parsed.data.events.size(), 1000U) << size << order;
            EXPECT_EQ(parsed.damage.total(), 0U) << size << order;
        }
}

TEST(Text, RowsOfWhichMostComeTooLateAreRefusedInWords) {
    const std::string text = text_of(rows_in_no_order(), "txyp");
    const TextOptions in_a_millisecond{.reorder = std::chrono::milliseconds(1)};
    try {
        read_text_header(to_bytes(text), in_a_millisecond);
        ADD_FAILURE() << "nothing was refused";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        const std::string words = error.what();
        EXPECT_NE(words.find("rows \"t x y p\" in order of time, at most 1ms late"), words.npos)
            << words;
        EXPECT_NE(words.find(" of 1000 later than that"), words.npos) << words;
        EXPECT_NE(words.find("--reorder"), words.npos) << words;
    }
    // A few rows tell nothing yet, and one wrong time is no disorder.
    EXPECT_NO_THROW(read_text_header(to_bytes("500000 1 1 1\n4 1 1 1\n3 1 1 1\n"), {}));
    std::vector<TextRow> ordered = rows_in_no_order();
    std::ranges::sort(ordered, {}, &TextRow::t_us);
    ordered[1].t_us = 5'000'000;
    EXPECT_NO_THROW(read_text_header(to_bytes(text_of(ordered, "txyp")), in_a_millisecond));
}

TEST(Text, PolaritiesAsFloatingPointAreNoTimes) {
    for (const char* text :
         {"90 3 1 1.0\n95 9 0 -1.0\n99 7 1 1.0\n", "90,3,1,1.0\n95,9,0,0.0\n99,7,1,1.0\n",
          "3 1 1.0 90\n9 0 0.0 95\n7 1 1.0 99\n"}) {
        const Parsed parsed = parse_text(text);
        ASSERT_EQ(parsed.data.events.size(), 3U) << text;
        EXPECT_EQ(parsed.data.events[1], (Event{from_us(95), 9, 0, Polarity::off})) << text;
        EXPECT_EQ(parsed.data.events[2], (Event{from_us(99), 7, 1, Polarity::on})) << text;
    }
    // Whole seconds as times are not taken for polarities while others are there.
    EXPECT_EQ(parse_text("0.0 3 1 1\n1.0 9 0 0\n2.0 7 1 1\n").data.events.size(), 3U);
}

TEST(Text, RowsThatFitNoLayoutAreRefusedInWords) {
    for (const char* text : {"0.1 7 8 9\n0.2 5 6 7\n", "t x y p\n0.1 7 8 9\n0.2 5 6 7\n",
                             "1 2 3 0\n4 5 6 255\n7 8 9 2\n7 8 9 3\n7 8 9 4\n"}) {
        try {
            read_text_header(to_bytes(text), {});
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            EXPECT_NE(std::string(error.what()).find("rows \"t x y p\" with polarities"),
                      std::string::npos)
                << error.what();
        }
    }
    EXPECT_THROW(read_text_header(to_bytes("9 2 3 1\n"), {"pxyt", {}}), Error) << "stated";
}

TEST(Text, ADamagedPolarityIsNoOtherWayToWriteThem) {
    std::string text;
    for (int i = 0; i < 50; ++i) text += std::to_string(100 + i) + " 7 2 1\n";
    const Parsed parsed = parse_text(text + "150 7 2 2\n");
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    ASSERT_EQ(parsed.data.events.size(), 50U);
    EXPECT_EQ(parsed.data.events[0].polarity, Polarity::on);
}

TEST(Text, ASizeThatNoSensorHasIsRefused) {
    for (const char* size : {"100000 260", "0 260", "346 99999999999"})
        EXPECT_THROW(read_text_header(to_bytes(size + std::string("\n0.1 1 2 1\n")), {}), Error)
            << size;
}

TEST(Text, OtherBytesDoNotLookLikeText) {
    for (const char* text :
         {"0.1 1 2 1\n", "240 180\n1 2 3 0\n", "# c\nt x y p\n1 2 3 0\n", "1,2,3,true\n"})
        EXPECT_TRUE(looks_like_text(to_bytes(text))) << text;
    for (const char* text : {"", "\n\n", "hello world\n", "1 2 3\n", "#!AER-DAT2.0\r\n",
                             "1 2\n3 4\n", "{\"t\": 1}\n", "<xml>\n"})
        EXPECT_FALSE(looks_like_text(to_bytes(text))) << text;
    EXPECT_FALSE(looks_like_text(to_bytes(std::string_view("1 2 3 0\n\0\0\1\2", 12))));
}

}  // namespace
}  // namespace eventide
