// EVT3, word by word, and what the writer makes of events.
#include "src/codec/prophesee/evt3.h"
#include "src/codec/prophesee/evt_header.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "tests/codec/data_files.h"
#include "tests/codec/parser_checks.h"

#include <string>

namespace eventide {
namespace {

constexpr int kWidth = 1280, kHeight = 720;
constexpr auto kOn = Polarity::on, kOff = Polarity::off;

using Words = std::vector<std::uint16_t>;

std::uint16_t word(unsigned type, unsigned content) {
    return std::uint16_t(type << 12 | content);
}
std::uint16_t addr_y(unsigned y) {
    return word(0x0, y);
}
std::uint16_t addr_x(unsigned x, bool on = false) {
    return word(0x2, x | unsigned(on) << 11);
}
std::uint16_t vect_base_x(unsigned x, bool on = false) {
    return word(0x3, x | unsigned(on) << 11);
}
std::uint16_t vect_12(unsigned mask) {
    return word(0x4, mask);
}
std::uint16_t vect_8(unsigned mask) {
    return word(0x5, mask);
}
std::uint16_t time_low(unsigned t) {
    return word(0x6, t);
}
std::uint16_t time_high(unsigned t) {
    return word(0x8, t);
}
std::uint16_t ext_trigger(unsigned id, bool rising) {
    return word(0xA, id << 8 | unsigned(rising));
}

Bytes to_stream(const Words& words) {
    Bytes out;
    for (const std::uint16_t w : words) append_little(out, w);
    return out;
}

const MakeParser kMake = [] { return std::make_unique<Evt3Parser>(kWidth, kHeight); };

Parsed parse(const Words& words) {
    return parse_whole(kMake, to_stream(words));
}

Event event(std::int64_t t, int x, int y, Polarity polarity = kOff) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), polarity};
}

void expect_events(const Parsed& parsed, const std::vector<Event>& expected) {
    EXPECT_TRUE(parsed.data.events == expected) << parsed.data.events.size() << " events";
}

constexpr std::int64_t kHigh = 4096;  // us

TEST(Evt3, AnEventIsARowAColumnAndATime) {
    expect_events(parse({time_high(3), addr_y(4), addr_x(5)}), {event(3 * kHigh, 5, 4)});
    expect_events(parse({time_high(3), time_low(7), addr_y(4), addr_x(5, true), addr_x(2),
                         time_low(9), addr_x(6), addr_y(1), addr_x(1279)}),
                  {event(3 * kHigh + 7, 5, 4, kOn), event(3 * kHigh + 7, 2, 4),
                   event(3 * kHigh + 9, 6, 4), event(3 * kHigh + 9, 1279, 1)});
}

TEST(Evt3, AVectorIsTwelveOrEightColumns) {
    expect_events(parse({time_high(1), addr_y(4), vect_base_x(100, true), vect_12(0x801),
                         vect_12(0), vect_8(0x81), vect_8(1)}),
                  {event(kHigh, 100, 4, kOn), event(kHigh, 111, 4, kOn), event(kHigh, 124, 4, kOn),
                   event(kHigh, 131, 4, kOn), event(kHigh, 132, 4, kOn)});
}

TEST(Evt3, TimeWrapsAndGoesOn) {
    const std::int64_t wrap = 1 << 24;
    expect_events(parse({time_high(4095), time_low(4095), addr_y(1), addr_x(1), time_high(0),
                         addr_x(2), time_low(5), addr_x(3)}),
                  {event(wrap - 1, 1, 1), event(wrap, 2, 1), event(wrap + 5, 3, 1)});
    Words words{time_high(0), addr_y(0)};
    for (unsigned i = 1; i <= 100; ++i) words.push_back(time_high(i * 200 % 4096));
    words.push_back(addr_x(9));
    expect_events(parse(words), {event(100 * 200 * kHigh, 9, 0)});
}

TEST(Evt3, AFallSmallerThanAWrapIsNoise) {
    const Parsed parsed = parse({time_high(100), addr_y(1), addr_x(1), time_high(99), addr_x(2),
                                 time_high(101), addr_x(3)});
    expect_events(parsed, {event(100 * kHigh, 1, 1), event(101 * kHigh, 3, 1)});
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 1U);
    EXPECT_EQ(parsed.damage.total(), 1U);
}

TEST(Evt3, AFlippedHighTimeCostsOnlyWhatFollowsIt) {
    for (unsigned bit = 10; bit < 12; ++bit) {
        const Parsed parsed =
            parse({time_high(100), addr_y(1), addr_x(1), time_high(101 ^ 1U << bit), addr_x(2),
                   time_high(102), addr_x(3)});
        expect_events(parsed, {event(100 * kHigh, 1, 1), event(102 * kHigh, 3, 1)});
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 2U);
    }
}

TEST(Evt3, AFlippedBitOfAnyHighTimeCostsATenthOfASecond) {
    for (const unsigned first : {0x5A5U, 0xFFFU - 20U}) {  // the second wraps
        std::vector<Event> events;
        Words words;
        for (unsigned i = 0; i < 60; ++i) {
            words.insert(words.end(), {time_high((first + i) & 0xFFF), addr_y(1), addr_x(i)});
            events.push_back(event((first + i) * kHigh, int(i), 1));
        }
        expect_events(parse(words), events);
        for (std::size_t at = 0; at < words.size(); at += 3)
            for (unsigned bit = 0; bit < 12; ++bit) {
                Words flipped = words;
                flipped[at] = std::uint16_t(flipped[at] ^ 1U << bit);
                expect_most_events_kept(parse(flipped), events, 25,
                                        std::to_string(at) + ", bit " + std::to_string(bit));
            }
    }
}

TEST(Evt3, ATimeInDoubtDoesNotMoveTheClock) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream({time_high(100), time_high(100), time_high(612), time_low(5)}), batch);
    EXPECT_EQ(parser.clock(), from_us(100 * kHigh));
    parser.parse(to_stream({time_high(612)}), batch);
    EXPECT_EQ(parser.clock(), from_us(612 * kHigh + 5));
}

TEST(Evt3, ALeapThatIsConfirmedIsBelieved) {
    const Parsed parsed =
        parse({time_high(100), addr_y(1), addr_x(1), time_high(1500), time_high(1500), addr_x(2)});
    expect_events(parsed, {event(100 * kHigh, 1, 1), event(1500 * kHigh, 2, 1)});
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Evt3, WhatComesBeforeTheFirstTimeIsPassedOver) {
    const Parsed parsed = parse({addr_x(3), time_low(8), addr_y(1), addr_x(1), vect_12(3),
                                 ext_trigger(1, true), time_high(1), addr_x(7)});
    expect_events(parsed, {event(kHigh, 7, 1)});
    EXPECT_TRUE(parsed.data.triggers.empty());
    EXPECT_EQ(parsed.damage.total(), 0U);
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

TEST(Evt3, TheClockGoesOnWithoutEvents) {
    EXPECT_EQ(parse({}).clock, std::nullopt);
    EXPECT_EQ(parse({time_high(5)}).clock, from_us(5 * kHigh));
    EXPECT_EQ(parse({time_high(5), time_low(7)}).clock, from_us(5 * kHigh + 7));
}

TEST(Evt3, AfterALossItTakesUpAtTheNextTime) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.parse(to_stream({time_high(4095), addr_y(1), addr_x(1)}), batch);
    parser.resync();
    parser.parse(to_stream({addr_x(2), time_high(2), addr_x(3), addr_y(4), addr_x(5)}), batch);
    parser.finish(batch);
    const std::vector<Event> expected{event(4095 * kHigh, 1, 1), event(4098 * kHigh, 5, 4)};
    EXPECT_TRUE(batch.events == expected);
}

constexpr HostTime host_at(std::int64_t us) {
    return HostTime{std::chrono::microseconds{us}};
}

/// What a camera tells that has seen times up to 10 s, was away for a minute and says these words.
std::vector<Event> after_coming_back(const Words& words, DamageReason counted,
                                     std::uint64_t times) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.arrives(host_at(5000));
    parser.parse(to_stream({time_high(2440), time_high(2441)}), batch);
    parser.reopened();
    parser.arrives(host_at(5000 + 60'000'000));
    parser.parse(to_stream(words), batch);
    parser.finish(batch);
    EXPECT_EQ(parser.damaged()[counted], times);
    EXPECT_EQ(parser.damaged().total(), times);
    return batch.events;
}

TEST(Evt3, ACameraThatWasOpenedAgainGoesOnByTheHostsClock) {
    constexpr std::int64_t kBack = (2442 + 60'000'000 / kHigh) * kHigh;
    for (const unsigned begin : {0U, 2000U, 2441U, 4095U}) {
        const unsigned next = (begin + 1) % 4096;
        EXPECT_EQ(after_coming_back({time_high(begin), time_low(7), addr_y(4), addr_x(5),
                                     time_high(next), time_low(3), addr_x(6)},
                                    DamageReason::bad_record, 0),
                  (std::vector{event(kBack + 7, 5, 4), event(kBack + kHigh + 3, 6, 4)}))
            << begin;
    }
    // One from before its clock was set to zero.
    EXPECT_EQ(after_coming_back({time_high(1500), time_high(0), time_low(7), addr_y(4), addr_x(5),
                                 time_high(1), time_low(3), addr_x(6)},
                                DamageReason::bad_record, 1),
              (std::vector{event(kBack + 7, 5, 4), event(kBack + kHigh + 3, 6, 4)}));
}

TEST(Evt3, ACameraThatIsOpenedAgainAtOnceIsNotInThePast) {
    Evt3Parser parser(kWidth, kHeight);
    Batch batch;
    parser.arrives(host_at(0));
    parser.parse(to_stream({time_high(9), time_high(9), time_low(4000), addr_y(1), addr_x(1)}),
                 batch);
    for (int times = 0; times < 3; ++times) {
        parser.reopened();
        parser.arrives(host_at(0));
        parser.parse(to_stream({time_high(0), time_high(0), time_low(1), addr_y(1), addr_x(1)}),
                     batch);
    }
    const std::vector<Event> expected{event(9 * kHigh + 4000, 1, 1), event(10 * kHigh + 1, 1, 1),
                                      event(11 * kHigh + 1, 1, 1), event(12 * kHigh + 1, 1, 1)};
    EXPECT_EQ(batch.events, expected);
}

/// Rows full of neighbours, lone events, silences, and triggers between.
Batch busy_batch(unsigned seed, std::size_t n, std::int64_t t = 1'633'953'690'975'950) {
    std::mt19937 random(seed);
    Batch batch;
    while (batch.events.size() < n) {
        t += std::int64_t(random() % (random() % 50 == 0 ? 30'000'000 : 40));
        if (random() % 20 == 0)
            batch.triggers.push_back({from_us(t),
                                      random() % 2 ? Trigger::Kind::rising : Trigger::Kind::falling,
                                      std::uint8_t(random() % 16)});
        const int y = int(random() % kHeight);
        const unsigned density = random() % 8;
        if (density == 0) {
            batch.events.push_back(event(t, int(random() % kWidth), y, Polarity(random() % 2)));
            continue;
        }
        const auto polarity = Polarity(random() % 2);
        const int begin = int(random() % kWidth),
                  end = std::min(kWidth, begin + int(random() % 90));
        for (int x = begin; x < end; ++x)
            if (random() % 8 <= density) batch.events.push_back(event(t, x, y, polarity));
    }
    return batch;
}

Bytes write(const Batch& batch) {
    Evt3Writer writer;
    StreamHeader header;
    header.width = kWidth;
    header.height = kHeight;
    header.serial = "00001034";
    Bytes out;
    writer.begin(header, out);
    writer.write(batch, out);
    writer.finish(out);
    return out;
}

Parsed parse_file(const Bytes& file) {
    const EvtHeader header = read_evt_header(file);
    const auto make = [&] {
        return std::make_unique<Evt3Parser>(header.stream.width, header.stream.height,
                                            header.time_base_us);
    };
    return parse_whole(make, std::span(file).subspan(header.stream.data_offset));
}

TEST(Evt3, WhatIsWrittenIsReadBack) {
    for (const std::int64_t first : {std::int64_t(0), std::int64_t(1) << 24, std::int64_t(-5),
                                     std::int64_t(1'633'953'690'975'950)}) {
        const Batch batch = busy_batch(1, 20'000, first);
        const Parsed parsed = parse_file(write(batch));
        EXPECT_TRUE(parsed.data.events == batch.events) << first;
        EXPECT_TRUE(parsed.data.triggers == batch.triggers);
        EXPECT_EQ(parsed.damage.total(), 0U);
    }
}

TEST(Evt3, VectorsAreWrittenWhereTheyPay) {
    Batch dense, sparse;
    for (int x = 0; x < 640; ++x) dense.events.push_back(event(1, x, 7, kOn));
    for (int x = 0; x < 640; ++x) sparse.events.push_back(event(1, 2 * (x % 600), x % 2, kOn));
    const std::size_t header = write({}).size();
    EXPECT_LT(write(dense).size() - header, 2 * (640 / 32 * 3 + 5));
    EXPECT_LT(write(sparse).size() - header, 2 * (2 * 640 + 5));
}

TEST(Evt3, AnySplitGivesTheSame) {
    const Bytes file = write(busy_batch(2, 3000, 0));
    expect_same_for_any_split(kMake,
                              std::span(file).subspan(read_evt_header(file).stream.data_offset));
}

TEST(Evt3, ACutGivesABeginning) {
    const Bytes file = write(busy_batch(3, 300, 0));
    expect_beginnings_for_any_cut(
        kMake, std::span(file).subspan(read_evt_header(file).stream.data_offset));
}

TEST(Evt3, FlippedBitsAreBorne) {
    const Bytes file = write(busy_batch(4, 1000, 0));
    const auto offset = std::ptrdiff_t(read_evt_header(file).stream.data_offset);
    expect_bears_damage(kMake, Bytes(file.begin() + offset, file.end()), kWidth, kHeight);
}

TEST(Evt3, ARealRecordingGivesItsNumbers) {
    const Bytes file = read_data_file("evt3_1280x720_5000.raw");
    if (file.empty()) GTEST_SKIP() << "no shared/data/formats";
    const EvtHeader header = read_evt_header(file);
    EXPECT_EQ(header.stream.format, "evt3");
    EXPECT_EQ(header.stream.width, 1280);
    EXPECT_EQ(header.stream.height, 720);
    EXPECT_EQ(header.stream.serial, "00001034");
    const Parsed parsed = parse_file(file);
    ASSERT_EQ(parsed.data.events.size(), 5000U);
    EXPECT_EQ(to_us(parsed.data.events.front().t), 5840504);
    EXPECT_EQ(to_us(parsed.data.events.back().t), 5885714);
    EXPECT_EQ(parsed.damage.total(), 0U);
    EXPECT_TRUE(parse_file(write(parsed.data)).data.events == parsed.data.events);
}

TEST(Evt3, WhatItCannotHoldIsRefusedByName) {
    Batch far_away, image, pulse, back;
    far_away.events = {event(1, 2048, 1)};
    image.images.resize(1);
    pulse.triggers = {{from_us(1), Trigger::Kind::pulse, 0}};
    back.events = {event(2, 1, 1), event(1, 1, 1)};
    for (const Batch& batch : {far_away, image, pulse, back}) {
        Bytes out;
        Evt3Writer writer;
        writer.begin({}, out);
        EXPECT_THROW(writer.write(batch, out), Error);
    }
}

}  // namespace
}  // namespace eventide
