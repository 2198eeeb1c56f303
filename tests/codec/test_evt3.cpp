// EVT3: what each word says.
#include "tests/codec/evt3_checks.h"

namespace eventide::evt3 {
namespace {

TEST(Evt3, AnEventIsARowAColumnAndATime) {
    expect_events(parse({time_high(3), addr_y(4), addr_x(5)}), {event(3 * kHigh, 5, 4)});
    expect_events(parse({time_high(3), time_low(7), addr_y(4), addr_x(5, true), addr_x(2),
                         time_low(9), addr_x(6), addr_y(1), addr_x(1279)}),
                  {event(3 * kHigh + 7, 5, 4, kOn), event(3 * kHigh + 7, 2, 4),
                   event(3 * kHigh + 9, 6, 4), event(3 * kHigh + 9, 1279, 1)});
}

/// Bit 11 of a row says which of two cameras it is of.
TEST(Evt3, ARowHasElevenBits) {
    for (const Words& begin : {Words{time_high(3)}, Words{time_high(3), time_high(3)}}) {
        Words words = begin;
        words.insert(words.end(), {addr_y(0x800 | 4), addr_x(5)});
        expect_events(parse(words), {event(3 * kHigh, 5, 4)});
    }
}

TEST(Evt3, AVectorIsTwelveOrEightColumns) {
    expect_events(parse({time_high(1), addr_y(4), vect_base_x(100, true), vect_12(0x801),
                         vect_12(0), vect_8(0x81), vect_8(1)}),
                  {event(kHigh, 100, 4, kOn), event(kHigh, 111, 4, kOn), event(kHigh, 124, 4, kOn),
                   event(kHigh, 131, 4, kOn), event(kHigh, 132, 4, kOn)});
}

TEST(Evt3, WhatComesBeforeTheFirstTimeIsPassedOver) {
    const Parsed parsed = parse({addr_x(3), time_low(8), addr_y(1), addr_x(1), vect_12(3),
                                 ext_trigger(1, true), time_high(1), addr_x(7)});
    expect_events(parsed, {event(kHigh, 7, 1)});
    EXPECT_TRUE(parsed.data.triggers.empty());
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Evt3, WhatNeedsARowOrAColumnWaitsForOneAlsoAfterALoss) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    for (unsigned n = 1; n <= 2; ++n) {
        parser.parse(to_stream({time_high(n), time_high(n), addr_x(3), vect_12(1), addr_y(4),
                                vect_8(1), addr_x(5), vect_base_x(6), vect_12(1)}),
                     batch);
        EXPECT_EQ(batch.events, (std::vector{event(n * kHigh, 5, 4), event(n * kHigh, 6, 4)}));
        batch.clear();
        parser.resync();
    }
    EXPECT_EQ(parser.damaged().total(), 0U);
}

TEST(Evt3, OtherWordsAreNoEvents) {
    const Parsed parsed = parse({time_high(1), addr_y(1), 0xE019, 0x9999, 0x9999, word(0xE, 0x14),
                                 word(0xF, 1), word(0xF, 2), word(0x7, 3), addr_x(7)});
    expect_events(parsed, {event(kHigh, 7, 1)});
    EXPECT_EQ(parsed.damage.total(), 0U);
    EXPECT_EQ(parse({time_high(1), word(0xB, 1), word(0xC, 1)}).damage[DamageReason::unknown_word],
              2U);
}

TEST(Evt3, PlacesOutsideTheSensorAreCounted) {
    const Parsed parsed =
        parse({time_high(1), addr_y(720), addr_x(1), vect_base_x(3), vect_12(7), addr_y(5),
               addr_x(1280), vect_base_x(1275), vect_12(0xFFF), addr_x(8)});
    std::vector<Event> expected;
    for (int x = 1275; x < 1280; ++x) expected.push_back(event(kHigh, x, 5));
    expected.push_back(event(kHigh, 8, 5));
    expect_events(parsed, expected);
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 4U + 1U + 7U);
}

TEST(Evt3, TriggersHaveAnInputAndAnEdge) {
    const Parsed parsed =
        parse({time_high(1), ext_trigger(1, true), time_low(9), ext_trigger(15, false)});
    const std::vector<Trigger> expected{{from_us(kHigh), Trigger::Kind::rising, 1},
                                        {from_us(kHigh + 9), Trigger::Kind::falling, 15}};
    EXPECT_TRUE(parsed.data.triggers == expected);
}

TEST(Evt3, TheClockFollowsTimesAlsoWhereThereIsNoRow) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream({time_high(5), time_high(5), time_low(7)}), batch);
    EXPECT_EQ(parser.clock(), from_us(5 * kHigh + 7));
    parser.parse(to_stream({addr_y(720), time_low(9)}), batch);
    EXPECT_EQ(parser.clock(), from_us(5 * kHigh + 9));
    parser.parse(to_stream({addr_y(7), time_low(11)}), batch);
    EXPECT_EQ(parser.clock(), from_us(5 * kHigh + 11)) << "and where there is one";
}

/// Words of all kinds, places at the borders of a sensor of 300 x 200 among them.
Words any_words(std::mt19937& random) {
    const auto pick = [&](unsigned n) { return unsigned(random() % n); };
    const auto near = [&](unsigned side) {
        return pick(2) == 0 ? pick(side) : side - 15 + pick(20);
    };
    Words words;
    unsigned low = 0;
    for (int i = 0; i < 400; ++i) switch (pick(8)) {
            case 0:
                words.push_back(addr_y(near(200)));
                break;
            case 1:
                words.push_back(addr_x(near(300), pick(2) == 0));
                break;
            case 2:
                words.push_back(vect_base_x(near(300), pick(2) == 0));
                break;
            case 3:
                words.push_back(vect_12(pick(4096)));
                break;
            case 4:
                words.push_back(word(0x5, pick(4096)));  // the upper four bits mean nothing
                break;
            case 5:
                low += pick(10);
                words.push_back(time_low((pick(20) == 0 ? low - pick(low + 1) : low) & 0xFFF));
                break;
            case 6:
                words.push_back(ext_trigger(pick(16), pick(2) == 0));
                break;
            default:
                words.push_back(word(pick(2) == 0 ? 0xE : 0xB, pick(4096)));
        }
    return words;
}

/// While its first time is in doubt every word goes the careful way.
TEST(Evt3, TheQuickWayAndTheCarefulWayAgree) {
    const MakeParser make = [] { return std::make_unique<Evt3Parser>(300, 200); };
    for (unsigned seed = 0; seed < 50; ++seed) {
        std::mt19937 random{seed};
        Words words = any_words(random);
        words.insert(words.begin(), time_high(9));
        const Parsed careful = parse_whole(make, to_stream(words));
        words.insert(words.begin(), time_high(9));
        const Parsed quick = parse_whole(make, to_stream(words));
        EXPECT_EQ(quick.data.events, careful.data.events) << seed;
        EXPECT_EQ(quick.data.triggers, careful.data.triggers) << seed;
        EXPECT_TRUE(quick.damage == careful.damage) << seed;
        expect_orderly(quick, 300, 200);
    }
}

}  // namespace
}  // namespace eventide::evt3
