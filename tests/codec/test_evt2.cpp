// EVT2, word by word.
#include "src/codec/prophesee/evt_header.h"
#include "tests/codec/data_files.h"
#include "tests/codec/evt2_words.h"

namespace eventide::evt2 {
namespace {

TEST(Evt2, EachWordIsAnEvent) {
    const Parsed parsed = parse({time_high(3), cd(0, 5, 4, false), cd(63, 639, 479, true)});
    const std::vector<Event> expected{event(3 * kHigh, 5, 4),
                                      event(3 * kHigh + 63, 639, 479, true)};
    EXPECT_TRUE(parsed.data.events == expected);
    EXPECT_EQ(parsed.clock, from_us(3 * kHigh + 63));
}

TEST(Evt2, TimeWrapsAndGoesOn) {
    const Parsed parsed =
        parse({time_high(0x0FFFFFFF), cd(63, 1, 1, true), time_high(0), cd(0, 2, 1, true)});
    const std::int64_t wrap = std::int64_t(1) << 34;
    const std::vector<Event> expected{event(wrap - 1, 1, 1, true), event(wrap, 2, 1, true)};
    EXPECT_TRUE(parsed.data.events == expected);
}

TEST(Evt2, ASmallFallIsNoise) {
    const Parsed parsed =
        parse({time_high(100), cd(9, 1, 1, true), time_high(99), cd(0, 2, 1, true), time_high(100),
               cd(8, 3, 1, true), cd(9, 4, 1, true)});
    const std::vector<Event> expected{event(6409, 1, 1, true), event(6409, 4, 1, true)};
    EXPECT_TRUE(parsed.data.events == expected);
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 2U);
}

TEST(Evt2, AFlippedHighTimeCostsOnlyWhatFollowsIt) {
    for (unsigned bit = 20; bit < 28; ++bit) {
        const Parsed parsed = parse({time_high(100), cd(0, 1, 1, true), time_high(101 ^ 1U << bit),
                                     cd(0, 2, 1, true), time_high(102), cd(0, 3, 1, true)});
        const std::vector<Event> expected{event(6400, 1, 1, true), event(6528, 3, 1, true)};
        EXPECT_TRUE(parsed.data.events == expected) << bit;
    }
}

TEST(Evt2, AFlippedBitOfAnyHighTimeCostsATenthOfASecond) {
    std::vector<Event> events;
    Words words;
    for (unsigned i = 0; i < 60; ++i) {
        const unsigned high = 0x0A5A5A5A + 100 * i;  // every 6.4 ms
        words.push_back(time_high(high));
        words.push_back(cd(5, i, 1, true));
        events.push_back(event(high * kHigh + 5, int(i), 1, true));
    }
    EXPECT_TRUE(parse(words).data.events == events);
    for (std::size_t at = 0; at < words.size(); at += 2)
        for (unsigned bit = 0; bit < 28; ++bit) {
            Words flipped = words;
            flipped[at] ^= 1U << bit;
            expect_most_events_kept(parse(flipped), events, 17,
                                    std::to_string(at) + ", bit " + std::to_string(bit));
        }
}

TEST(Evt2, WhatWaitsForItsTimeToBeSureComesOut) {
    const std::uint32_t pause = 3'000'000 / 64;
    const Parsed parsed =
        parse({time_high(7), cd(1, 1, 1, true), ext_trigger(2, 3, true), time_high(7 + pause),
               cd(0, 2, 1, true), time_high(7 + 2 * pause), cd(0, 3, 1, true)});
    const std::vector<Event> expected{event(7 * kHigh + 1, 1, 1, true),
                                      event((7 + pause) * kHigh, 2, 1, true),
                                      event((7 + 2 * pause) * kHigh, 3, 1, true)};
    EXPECT_TRUE(parsed.data.events == expected);
    EXPECT_EQ(parsed.data.triggers.size(), 1U);
    EXPECT_EQ(parsed.clock, from_us((7 + 2 * pause) * kHigh));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Evt2, NoMoreWaitsThanMemoryIsMeantFor) {
    Words words{time_high(7)};
    words.resize(EvtTimeHigh::kMaxHeld + 2, cd(1, 1, 1, true));
    Evt2Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream(words), batch);
    EXPECT_EQ(batch.events.size(), EvtTimeHigh::kMaxHeld + 1);
}

TEST(Evt2, OtherWordsAreNoEvents) {
    const Parsed parsed =
        parse({cd(0, 9, 9, true), 0x99999999, time_high(1), time_high(1), 0xE0000014, 0xF1234567,
               0x99999999, ext_trigger(5, 23, true), 0x50000000, cd(6, 1, 2, true),
               cd(6, 640, 2, true), cd(6, 1, 480, true)});
    const std::vector<Event> expected{event(70, 1, 2, true)};
    EXPECT_TRUE(parsed.data.events == expected);
    const std::vector<Trigger> triggers{{from_us(69), Trigger::Kind::rising, 23}};
    EXPECT_TRUE(parsed.data.triggers == triggers);
    EXPECT_EQ(parsed.damage[DamageReason::unknown_word], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 2U);
    EXPECT_EQ(parsed.damage.total(), 3U);
}

TEST(Evt2, WhatComesBeforeTheFirstTimeIsPassedOver) {
    const Parsed parsed =
        parse({cd(1, 2, 3, true), ext_trigger(1, 5, true), time_high(1), cd(2, 3, 4, true)});
    EXPECT_EQ(parsed.data.events, (std::vector{event(kHigh + 2, 3, 4, true)}));
    EXPECT_TRUE(parsed.data.triggers.empty());
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Evt2, SplitsCutsAndFlippedBitsAreBorne) {
    const Bytes bytes = to_stream(some_words(1, 800));
    EXPECT_EQ(parse_whole(kMake2, bytes).damage.total(), 0U);
    expect_same_for_any_split(kMake2, bytes);
    expect_beginnings_for_any_cut(kMake2, std::span(bytes).first(400));
    expect_bears_damage(kMake2, bytes, kWidth, kHeight);
}

TEST(Evt2, ARealRecordingGivesItsNumbers) {
    const Bytes file = read_data_file("evt2_640x480.raw");
    if (file.empty()) GTEST_SKIP() << "no shared/data/formats";
    const EvtHeader header = read_evt_header(file);
    EXPECT_EQ(header.stream.format, "evt2");
    EXPECT_EQ(header.stream.width, kWidth);
    EXPECT_EQ(header.stream.height, kHeight);
    const Parsed parsed = parse_whole(kMake2, std::span(file).subspan(header.stream.data_offset));
    const auto& events = parsed.data.events;
    ASSERT_EQ(events.size(), 539481U);
    EXPECT_EQ(count_on(events), 367855U);
    EXPECT_EQ(to_us(events.front().t), 1317888);
    EXPECT_EQ(to_us(events.back().t), 1367888);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

/// Found by fuzzing: they came with the next word that tells a time, behind what came before that.
TEST(Evt2, EventsOfAFirstTimeBeforeAGapComeWithTheNextCall) {
    Evt2Parser parser{kWidth, kHeight};
    Batch batch;
    parser.parse(to_stream(Words{time_high(300), cd(0, 5, 4, false)}), batch);
    EXPECT_TRUE(batch.events.empty()) << "the first time waits for the next to agree";
    parser.resync();
    parser.parse({}, batch);
    EXPECT_EQ(batch.events, std::vector{event(300 * kHigh, 5, 4)});
    batch.clear();
    parser.parse(to_stream(Words{time_high(2), cd(1, 5, 4, false), time_high(2)}), batch);
    EXPECT_EQ(batch.events, std::vector{event(2 * kHigh + 1, 5, 4)});
}

TEST(Evt2, ACameraThatWasOpenedAgainGoesOnByTheHostsClock) {
    Evt2Parser parser(kWidth, kHeight);
    Batch batch;
    parser.arrives(HostTime{});
    parser.parse(to_stream(Words{time_high(900), time_high(900), cd(5, 1, 2, true)}), batch);
    parser.reopened();
    parser.arrives(HostTime{std::chrono::seconds{6}});
    parser.parse(to_stream(Words{time_high(0), cd(3, 1, 2, true), time_high(1)}), batch);
    EXPECT_EQ(batch.events, (std::vector{event(900 * kHigh + 5, 1, 2, true),
                                         event(901 * kHigh + 6'000'000 + 3, 1, 2, true)}));
}

TEST(Evt2, TheClockGoesOnWithoutEvents) {
    EXPECT_EQ(parse({}).clock, std::nullopt);
    EXPECT_EQ(parse({time_high(5)}).clock, from_us(5 * kHigh));
    EXPECT_EQ(parse({time_high(5), time_high(6)}).clock, from_us(6 * kHigh));
    EXPECT_EQ(parse({time_high(5), time_high(6), ext_trigger(9, 0, true)}).clock,
              from_us(6 * kHigh + 9));
}

TEST(Evt2, AfterAJumpBackReadingGoesOnThere) {
    Evt2Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream(Words{time_high(5000), time_high(5000), cd(5, 1, 2, true)}), batch);
    parser.resync();
    EXPECT_EQ(parser.clock(), std::nullopt);
    batch.clear();
    parser.parse(to_stream(Words{time_high(100), time_high(100), cd(6, 3, 4, true)}), batch);
    EXPECT_EQ(batch.events, std::vector{event(100 * kHigh + 6, 3, 4, true)});
    EXPECT_EQ(parser.damaged().total(), 0U);
}

/// While its first time is in doubt every word goes the careful way.
TEST(Evt2, TheQuickWayAndTheCarefulWayAgree) {
    for (unsigned seed = 0; seed < 50; ++seed) {
        std::mt19937 random{seed};
        const auto pick = [&](unsigned n) { return unsigned(random() % n); };
        Words words{time_high(9)};
        for (unsigned i = 0; i < 300; ++i)
            words.push_back(pick(9) == 0 ? ext_trigger(pick(64), pick(32), pick(2) == 0)
                                         : cd(std::min(63U, i / 5 + pick(2)), 630 + pick(12),
                                              470 + pick(12), pick(2) == 0));
        const Parsed careful = parse(words);
        words.insert(words.begin(), time_high(9));
        const Parsed quick = parse(words);
        EXPECT_EQ(quick.data.events, careful.data.events) << seed;
        EXPECT_EQ(quick.data.triggers, careful.data.triggers) << seed;
        EXPECT_TRUE(quick.damage == careful.damage) << seed;
    }
}

}  // namespace
}  // namespace eventide::evt2
