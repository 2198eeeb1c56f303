// Data of arrays and bags on their way: what goes in comes out, whatever the split.
#include "src/codec/plain_records.h"
#include "tests/codec/parser_checks.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

Batch some_data() {
    Batch batch;
    for (int i = 0; i < 2'000; ++i)
        batch.events.push_back({from_us(1'600'000'000'000'000 + 50 * i), std::uint16_t(i % 64),
                                std::uint16_t(i % 48), Polarity(i % 3 == 0)});
    for (int n = 0; n < 3; ++n) {
        ReferenceImage image;
        image.t = batch.events[std::size_t(600 * n + 50)].t;
        image.exposure_begin = image.t - SensorDuration{500};
        image.exposure_end = image.t + SensorDuration{500};
        image.x0 = n;
        image.y0 = -n;
        image.channels = n == 1 ? 3 : 1;
        if (n == 2) image.filter = ColourFilter::gbrg;
        image.pixels = Array2<std::uint16_t>(5, 7 * image.channels);
        for (std::size_t i = 0; i < image.pixels.values().size(); ++i)
            image.pixels.values()[i] = std::uint16_t(i * 1'999);
        batch.images.push_back(image);
    }
    batch.imu.push_back({batch.events[3].t, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}, 36.6F});
    batch.triggers.push_back({batch.events[1].t, Trigger::Kind::falling, 3});
    return batch;
}

Bytes bytes_of(const Batch& batch, const Damage& damage = {}) {
    Bytes bytes;
    append_plain_records(batch, damage, bytes);
    return bytes;
}

std::unique_ptr<Parser> make_parser() {
    return std::make_unique<PlainRecordsParser>(64, 48);
}

TEST(PlainRecords, GiveWhatWentIn) {
    const Batch batch = some_data();
    Damage damage;
    damage.count(DamageReason::bad_compression, 7);
    const Parsed parsed = parse_whole(make_parser, bytes_of(batch, damage));
    EXPECT_TRUE(parsed.data.events == batch.events);
    EXPECT_TRUE(parsed.data.images == batch.images);
    EXPECT_TRUE(parsed.data.imu == batch.imu);
    EXPECT_TRUE(parsed.data.triggers == batch.triggers);
    EXPECT_TRUE(parsed.damage == damage);
    EXPECT_EQ(parsed.clock, batch.events.back().t);
}

TEST(PlainRecords, AreTheSameForAnySplitTruncationAndDamage) {
    Batch few = some_data();
    few.events.resize(300);
    const Bytes bytes = bytes_of(few);
    expect_same_for_any_split(make_parser, bytes);
    expect_beginnings_for_any_cut(make_parser, bytes);
    expect_bears_damage(make_parser, bytes, 64, 48);
}

TEST(PlainRecords, AnImageComesBeforeTheEventsOfItsTime) {
    const Batch batch = some_data();
    const Bytes bytes = bytes_of(batch);
    PlainRecordsParser parser(64, 48);
    Batch into;
    for (std::size_t at = 0; at < bytes.size() && into.images.empty(); at += 16)
        parser.parse(std::span(bytes).subspan(at, std::min<std::size_t>(16, bytes.size() - at)),
                     into);
    ASSERT_EQ(into.images.size(), 1U);
    EXPECT_LT(into.events.back().t, into.images[0].t);
}

TEST(PlainRecords, AnImageWithATimeOfItsOwnIsNoSilence) {
    const auto clock_of = [](std::initializer_list<std::int64_t> images_at) {
        Batch batch = some_data();
        batch.images.resize(1, batch.images[0]);
        const ReferenceImage image = batch.images[0];
        batch.images.clear();
        for (const std::int64_t us : images_at) {
            batch.images.push_back(image);
            batch.images.back().t = from_us(us);
        }
        return parse_whole(make_parser, bytes_of(batch)).clock;
    };
    const std::int64_t end = to_us(some_data().events.back().t), far = end + 3'600'000'000;
    EXPECT_EQ(clock_of({far, end + 40'000}), from_us(end + 40'000));
    EXPECT_EQ(clock_of({far, far + 40'000}), from_us(far + 40'000));
    EXPECT_EQ(clock_of({far}), from_us(far)) << "nothing contradicts it";
}

TEST(PlainRecords, EventsPassTheRulesOfEveryFormat) {
    Batch batch;
    batch.events = {{from_us(100), 1, 1, Polarity::on},
                    {from_us(200), 64, 1, Polarity::on},  // beside the sensor
                    {from_us(50), 1, 1, Polarity::on},    // before the one before it
                    {from_us(300), 2, 2, Polarity::off}};
    const Parsed parsed = parse_whole(make_parser, bytes_of(batch));
    EXPECT_EQ(parsed.data.events.size(), 2U);
    EXPECT_EQ(parsed.damage[DamageReason::out_of_range], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::time_backwards], 1U);
}

}  // namespace
}  // namespace eventide
