// EVT2 and EVT2.1, word by word, and RAW headers through the years.
#include "src/codec/prophesee/evt2.h"
#include "src/codec/prophesee/evt_header.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "tests/codec/data_files.h"
#include "tests/codec/parser_checks.h"

namespace eventide {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr std::int64_t kHigh = 64;  // us
using Order = Evt21Parser::Order;
using Words = std::vector<std::uint32_t>;

std::uint32_t cd(unsigned t, unsigned x, unsigned y, bool on) {
    return std::uint32_t(on) << 28 | t << 22 | x << 11 | y;
}
std::uint32_t time_high(std::uint32_t t) {
    return 0x80000000U | t;
}
std::uint32_t ext_trigger(unsigned t, unsigned id, bool rising) {
    return 0xA0000000U | t << 22 | id << 8 | unsigned(rising);
}

Bytes to_stream(const Words& words) {
    Bytes out;
    for (const std::uint32_t w : words) append_little(out, w);
    return out;
}

/// EVT2.1: {upper half, lower half}
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
Bytes to_stream(const Pairs& words, Order order) {
    Bytes out;
    for (const auto& [upper, lower] : words) {
        append_little(out, order == Order::upper_half_first ? upper : lower);
        append_little(out, order == Order::upper_half_first ? lower : upper);
    }
    return out;
}

const MakeParser kMake2 = [] { return std::make_unique<Evt2Parser>(kWidth, kHeight); };
MakeParser make21(Order order) {
    return [order] { return std::make_unique<Evt21Parser>(kWidth, kHeight, order); };
}

Parsed parse(const Words& words) {
    return parse_whole(kMake2, to_stream(words));
}

Event event(std::int64_t t, int x, int y, bool on = false) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), Polarity(on)};
}

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
    const Parsed parsed = parse({cd(0, 9, 9, true), 0x99999999, time_high(1), 0xE0000014,
                                 0xF1234567, 0x99999999, ext_trigger(5, 7, true), 0x50000000,
                                 cd(6, 1, 2, true), cd(6, 640, 2, true), cd(6, 1, 480, true)});
    const std::vector<Event> expected{event(70, 1, 2, true)};
    EXPECT_TRUE(parsed.data.events == expected);
    const std::vector<Trigger> triggers{{from_us(69), Trigger::Kind::rising, 7}};
    EXPECT_TRUE(parsed.data.triggers == triggers);
    EXPECT_EQ(parsed.damage[DamageReason::unknown_word], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 2U);
    EXPECT_EQ(parsed.damage.total(), 3U);
}

Words some_words(unsigned seed, std::size_t n) {
    std::mt19937 generator(seed);
    const auto random = [&] { return unsigned(generator()); };
    Words words;
    std::uint32_t t = 1000;
    while (words.size() < n) {
        t += 1 + random() % 3;
        words.push_back(time_high(t));
        unsigned low = 0;
        for (unsigned k = random() % 10; k > 0; --k)
            words.push_back(cd(low = std::min(63U, low + random() % 9), random() % kWidth,
                               random() % kHeight, random() % 2 == 1));
        if (random() % 9 == 0) words.push_back(ext_trigger(low, random() % 32, random() % 2 == 1));
    }
    return words;
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

TEST(EvtHeader, SaysTheSensorInManyWays) {
    const auto name = [](const std::string& lines) {
        return read_evt_header(to_bytes("% evt 3.0\n" + lines)).stream.sensor_name;
    };
    EXPECT_EQ(name("% sensor_name IMX646\n% sensor_generation 4.2\n% system_ID 49\n"), "IMX646");
    EXPECT_EQ(name("% camera_integration_name DAVIS346\n"), "DAVIS346");
    EXPECT_EQ(name("% sensor_generation 4.2\n"), "IMX636");
    EXPECT_EQ(name("% sensor_generation 3.1\n"), "Gen3.1");
    EXPECT_EQ(name("% system_ID 48\n"), "Gen4.1");
    EXPECT_EQ(name("% system_ID 99\n"), "99");
    EXPECT_EQ(name(""), "");
}

TEST(EvtHeader, WithoutAWordOnItEarlySystemsSwapTheHalvesOfEvt21) {
    const auto swapped = [](const std::string& lines) {
        return read_evt_header(to_bytes("% evt 2.1\n" + lines)).halves_swapped;
    };
    for (const char* lines :
         {"% system_ID 49\n", "% system_ID 54\n% integrator_name Prophesee\n",
          "% plugin_integrator_name Prophesee\n% camera_integrator_name Prophesee\n"
          "% system_ID 49\n"})
        EXPECT_TRUE(swapped(lines)) << lines;
    for (const char* lines :
         {"", "% system_ID 0\n", "% system_ID 55\n", "% system_ID 49\n% endianness little\n",
          "% system_ID 49\n% format EVT21;endianness=little\n",
          "% system_ID 49\n% camera_integrator_name Other\n",
          "% system_ID 49\n% plugin_integrator_name Other\n"})
        EXPECT_FALSE(swapped(lines)) << lines;
}

TEST(EvtHeader, SaysFormatAndSizeInManyWays) {
    struct Case {
        const char* text;
        const char* format;
        int width, height;
        bool swapped;
    };
    for (const Case& c :
         {Case{"% format EVT3;height=720;width=1280\n% end\n", "evt3", 1280, 720, false},
          Case{"% evt 3.0\n% geometry 320x320\n", "evt3", 320, 320, false},
          Case{"% evt 2.1\n% endianness legacy\n% system_ID 49\n", "evt21", 1280, 720, true},
          Case{"% format EVT21;endianness=legacy;height=5;width=6\r\n", "evt21", 6, 5, true},
          Case{"% evt 2.0\n% system_ID 21\n", "evt2", 640, 480, false},
          Case{"% system_ID 21\n", "evt2", 640, 480, false},
          Case{"% system_ID 40\n% integrator_name Prophesee\n", "evt3", 640, 480, false},
          Case{"% system_ID 49\n% serial_number 1\n", "evt3", 1280, 720, false},
          Case{"% evt 3.0\n% system_ID 49\n% plugin_integrator_name Other\n", "evt3", 0, 0, false},
          Case{"% evt 2.0\n% geometry -5xfoo\n", "evt2", 0, 0, false}}) {
        Bytes bytes = to_bytes(c.text);
        const std::size_t header_bytes = bytes.size();
        for (const int b : {0x25, 0x80, 0x0A, 0xFF}) bytes.push_back(std::byte(b));
        const EvtHeader header = read_evt_header(bytes);
        EXPECT_EQ(header.stream.format, c.format);
        EXPECT_EQ(header.stream.width, c.width) << c.text;
        EXPECT_EQ(header.stream.height, c.height);
        EXPECT_EQ(header.halves_swapped, c.swapped);
        EXPECT_EQ(header.stream.data_offset, header_bytes);
    }
    EXPECT_THROW(read_evt_header(to_bytes("% evt 9.0\n")), Error);
    EXPECT_THROW(read_evt_header(to_bytes("% evt 9.0\n% system_ID 49\n")), Error);
    EXPECT_THROW(read_evt_header(to_bytes("% system_ID 99\n")), Error);
    EXPECT_THROW(read_evt_header(to_bytes("")), Error);
}

}  // namespace
}  // namespace eventide
