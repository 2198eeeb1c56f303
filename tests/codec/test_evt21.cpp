// EVT2.1, word by word, in both orders of its halves.
#include "tests/codec/evt2_words.h"

namespace eventide::evt2 {
namespace {

TEST(Evt21, AWordIsUpTo32Columns) {
    for (const Order order : {Order::lower_half_first, Order::upper_half_first}) {
        const Bytes bytes = to_stream({{time_high(3), 0},
                                       {cd(5, 32, 4, true), 0x80000001},
                                       {cd(6, 608, 5, false), 2},
                                       {ext_trigger(7, 1, false), 0},
                                       {0xE0000019, 0},
                                       {0x99999999, 0x99999999},
                                       {cd(8, 632, 5, false), 0x101}},
                                      order);
        const Parsed parsed = parse_whole(make21(order), bytes);
        const std::vector<Event> expected{event(197, 32, 4, true), event(197, 63, 4, true),
                                          event(198, 609, 5), event(200, 632, 5)};
        EXPECT_TRUE(parsed.data.events == expected);
        const std::vector<Trigger> triggers{{from_us(199), Trigger::Kind::falling, 1}};
        EXPECT_TRUE(parsed.data.triggers == triggers);
        EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 1U);
        EXPECT_EQ(parsed.damage.total(), 1U);
    }
}

TEST(Evt21, SplitsCutsAndFlippedBitsAreBorne) {
    std::mt19937 generator(7);
    const auto random = [&] { return unsigned(generator()); };
    Pairs words;
    for (const std::uint32_t word : some_words(2, 500)) {
        const bool is_event = word >> 28 <= 1;
        words.emplace_back(is_event ? word & ~(31U << 11) : word, is_event ? random() : 0);
    }
    const Bytes bytes = to_stream(words, Order::upper_half_first);
    const MakeParser make = make21(Order::upper_half_first);
    expect_same_for_any_split(make, bytes);
    expect_beginnings_for_any_cut(make, std::span(bytes).first(400));
    expect_bears_damage(make, bytes, kWidth, kHeight);
}

/// 640 columns are 20 words wide, other sensors' are no whole number of them.
TEST(Evt21, AWordThatReachesOverTheBorderGivesWhatIsInside) {
    const MakeParser make = [] { return std::make_unique<Evt21Parser>(304, 240); };
    const Bytes bytes = to_stream({{time_high(3), 0},
                                   {time_high(3), 0},
                                   {cd(5, 288, 4, true), 0x00018003},
                                   {cd(5, 288, 4, true), 0x00000004},
                                   {cd(6, 273, 240, true), 1},
                                   {cd(6, 32, 240, true), 1},
                                   {cd(6, 273, 239, true), 0x80000000}},
                                  Order::lower_half_first);
    const Parsed parsed = parse_whole(make, bytes);
    EXPECT_EQ(parsed.data.events,
              (std::vector{event(197, 288, 4, true), event(197, 289, 4, true),
                           event(197, 303, 4, true), event(197, 290, 4, true)}));
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 4U);
    EXPECT_EQ(parsed.damage.total(), 4U);
}

TEST(Evt21, AWordWithoutEventsHasNoTime) {
    const Bytes bytes = to_stream(
        {{time_high(3), 0}, {time_high(3), 0}, {cd(50, 32, 4, true), 0}, {cd(40, 32, 4, true), 1}},
        Order::lower_half_first);
    const Parsed parsed = parse_whole(make21(Order::lower_half_first), bytes);
    EXPECT_EQ(parsed.data.events, std::vector{event(3 * kHigh + 40, 32, 4, true)});
}

TEST(Evt21, HalfAPaddingIsNone) {
    const Bytes bytes =
        to_stream({{0x99999999, 0x99999999}, {0x99999999, 5}}, Order::lower_half_first);
    EXPECT_EQ(
        parse_whole(make21(Order::lower_half_first), bytes).damage[DamageReason::unknown_word], 1U);
}

}  // namespace
}  // namespace eventide::evt2
