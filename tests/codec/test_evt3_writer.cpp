// EVT3: whole recordings, written and read back.
#include "src/codec/prophesee/evt_header.h"
#include "src/core/error.h"
#include "tests/codec/data_files.h"
#include "tests/codec/evt3_checks.h"
#include "tests/support/error_of.h"

#include <gmock/gmock.h>

namespace eventide::evt3 {
namespace {

using testing::HasSubstr;

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
    header.sensor_name = "IMX636";
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
    for (const std::int64_t first :
         {std::int64_t(0), std::int64_t(1) << 24, std::int64_t(-60'000'000),
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

TEST(Evt3Writer, NamesTheSensorAsOpenEbReadsIt) {
    const Bytes file = write(busy_batch(4, 10, 0));
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    EXPECT_NE(text.find("\n% sensor_name IMX636\n"), text.npos);
    EXPECT_EQ(read_evt_header(file).stream.sensor_name, "IMX636");
}

TEST(Evt3Writer, NeighboursOfBothPolaritiesAndAPixelTwiceAtATimeAreKept) {
    Batch batch;
    for (int x = 0; x < 8; ++x) batch.events.push_back(event(5, x, 1, Polarity(x % 2)));
    for (const int x : {10, 11, 11, 12, 13, 14, 15}) batch.events.push_back(event(5, x, 1, kOn));
    EXPECT_TRUE(parse_file(write(batch)).data.events == batch.events);
}

Trigger edge(std::int64_t t, Trigger::Kind kind = Trigger::Kind::rising) {
    return {from_us(t), kind, 3};
}

TEST(Evt3Writer, TriggersBeforeAllEventsOrWithoutAnyKeepTheirTimes) {
    constexpr std::int64_t kMinute = 60'000'000;  // more than the 24 bits of EVT3 hold
    Batch before, alone;
    before.triggers = alone.triggers = {edge(5 * kMinute)};
    before.events = {event(6 * kMinute, 1, 2)};
    for (const Batch& batch : {before, alone}) {
        const Parsed parsed = parse_file(write(batch));
        EXPECT_TRUE(parsed.data.triggers == batch.triggers);
        EXPECT_TRUE(parsed.data.events == batch.events);
    }
}

TEST(Evt3Writer, TriggersAreWrittenInOrderAndOneBehindLaterEventsAtTheirTime) {
    Evt3Writer writer;
    Bytes out;
    writer.begin({}, out);
    Batch first, second;
    first.events = {event(20, 1, 2)};
    first.triggers = {edge(30), edge(20), edge(10)};
    second.events = {event(25, 1, 2), event(40, 1, 2)};
    second.triggers = {edge(15, Trigger::Kind::falling)};
    writer.write(first, out);
    writer.write(second, out);
    writer.finish(out);
    const Parsed parsed = parse_file(out);
    EXPECT_THAT(
        parsed.data.triggers,
        testing::ElementsAre(edge(10), edge(20), edge(20, Trigger::Kind::falling), edge(30)));
    EXPECT_EQ(parsed.data.events.size(), 3U);
}

TEST(Evt3Writer, OfTriggersWithoutEventsOnlySoManyWait) {
    Evt3Writer writer;
    Batch many;
    for (std::int64_t t = 0; t < 70'000; ++t) many.triggers.push_back(edge(t));
    Bytes out;
    writer.begin({}, out);
    writer.write(many, out);
    EXPECT_GT(out.size(), 4U * (70'000 - 65'536));  // a time and a trigger each
    writer.finish(out);
    EXPECT_TRUE(parse_file(out).data.triggers == many.triggers);
}

TEST(Evt3Writer, ALineOfTheHeaderStaysOne) {
    StreamHeader header;
    header.sensor_name = "IMX\n% width 3";
    header.width = kWidth;
    header.height = kHeight;
    Bytes out;
    Evt3Writer writer;
    writer.begin(header, out);
    writer.finish(out);
    EXPECT_EQ(read_evt_header(out).stream.sensor_name, "IMX % width 3");
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
    const auto refusal = [](const Batch& batch) {
        Bytes out;
        Evt3Writer writer;
        writer.begin({}, out);
        return test::error_of([&] { writer.write(batch, out); });
    };
    Batch right, below, image, sample, pulse, input, back, leap;
    right.events = {event(1, 2047, 1), event(1, 2048, 1)};
    below.events = {event(1, 1, 2048)};
    image.images.resize(1);
    sample.imu.resize(1);
    pulse.triggers = {{from_us(1), Trigger::Kind::pulse, 0}};
    input.triggers = {{from_us(1), Trigger::Kind::rising, 16}};
    back.events = {event(2, 1, 1), event(1, 1, 1)};
    leap.events = {event(0, 1, 1), event(864'000'000'001, 1, 1)};
    EXPECT_THAT(refusal(right), HasSubstr("an event at 2048, 1;"));
    EXPECT_THAT(refusal(below), HasSubstr("an event at 1, 2048;"));
    EXPECT_THAT(refusal(image), HasSubstr("images"));
    EXPECT_THAT(refusal(sample), HasSubstr("IMU samples"));
    EXPECT_THAT(refusal(pulse), HasSubstr("from source 0"));
    EXPECT_THAT(refusal(input), HasSubstr("from source 16"));
    EXPECT_THAT(refusal(back), HasSubstr("step back"));
    EXPECT_THAT(refusal(leap), HasSubstr("more than 10 days"));
}

}  // namespace
}  // namespace eventide::evt3
