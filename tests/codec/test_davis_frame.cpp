// DAVIS images, from words spelled out.
#include "tests/codec/davis_words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace eventide::davis_words {
namespace {

/// A frame of 2 x 2 pixels at (10, 20). `brighter` is added to the samples of the first.
Words small_frame(bool with_last_column_end = true, int brighter = 0) {
    Words words{time(100), special(kGlobalFrame)};
    for (const int corner : {10, 20, 11, 21}) {
        words.push_back(roi_high(corner >> 8));
        words.push_back(roi_low(corner & 255));
    }
    const auto column = [&](int kind, int a, int b, bool end = true) {
        words.insert(words.end(), {special(kind), adc(a), adc(b)});
        if (end) words.push_back(special(kColumnEnd));
    };
    // DAVIS240 sends half of what the samples mean: 500 means 1000.
    column(kResetColumn, 500 + brighter, 500);
    column(kResetColumn, 500, 100);
    words.insert(words.end(),
                 {time(110), special(kExposureStart), time(210), special(kExposureEnd)});
    column(kSignalColumn, 450 + brighter, 400);
    column(kSignalColumn, 0, 90, with_last_column_end);
    words.insert(words.end(), {exposure(10), exposure(1), special(kFrameEnd)});
    return words;
}

TEST(DavisFrame, IsResetMinusSignalWithItsTimesAndPlace) {
    const auto parsed = parse(small_frame());
    ASSERT_EQ(parsed.data.images.size(), 1U);
    const ReferenceImage& image = parsed.data.images[0];
    EXPECT_EQ(image.x0, 10);
    EXPECT_EQ(image.y0, 20);
    EXPECT_EQ(to_us(image.exposure_begin), 110);
    EXPECT_EQ(to_us(image.exposure_end), 210);
    EXPECT_EQ(to_us(image.t), 160);
    EXPECT_EQ(image.pixels(0, 0), wide(100));
    EXPECT_EQ(image.pixels(1, 0), wide(200));
    EXPECT_EQ(image.pixels(0, 1), 65535);  // signal 0: over-exposed
    EXPECT_EQ(image.pixels(1, 1), 65535);  // reset level too low: over-exposed before it began
    EXPECT_EQ(parsed.damaged.total(), 0U);
}

TEST(DavisFrame, ADavis240sDoubledSamplesAreSubtractedBeforeTheyAreLimited) {
    const auto parsed = parse(small_frame(true, 100));  // reset 1200, signal 1100
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.data.images[0].pixels(0, 0), wide(100));
}

TEST(DavisFrame, MissingColumnEndLosesTheFrameAndIsCounted) {
    const auto parsed = parse(small_frame(false));
    EXPECT_TRUE(parsed.data.images.empty());
    EXPECT_EQ(parsed.damaged[DamageReason::bad_record], 1U);
}

TEST(DavisFrame, StartingInTheMiddleIsIgnored) {
    auto words = small_frame();
    words.erase(words.begin(), words.begin() + 12);
    EXPECT_TRUE(parse(words).data.images.empty());
}

/// Of a region with these corners, column by column as `reads` says.
struct Read {
    int at_us;
    int kind;  ///< kResetColumn or kSignalColumn
    std::vector<int> samples;
};
Words frame(int shutter, std::array<int, 4> corners, const std::vector<Read>& reads) {
    Words words{time(100), special(shutter)};
    for (const int corner : corners) {
        words.push_back(roi_high(corner >> 8));
        words.push_back(roi_low(corner & 255));
    }
    for (const Read& read : reads) {
        words.insert(words.end(), {time(read.at_us), special(read.kind)});
        for (const int sample : read.samples) words.push_back(adc(sample));
        words.push_back(special(kColumnEnd));
    }
    words.push_back(special(kFrameEnd));
    return words;
}
constexpr int kRollingFrame = 9;
constexpr std::array<int, 4> kCorners{10, 20, 11, 21};
const std::vector<Read> kReads{{110, kResetColumn, {400, 400}},
                               {120, kResetColumn, {400, 400}},
                               {200, kSignalColumn, {350, 300}},
                               {210, kSignalColumn, {250, 200}}};

TEST(DavisFrame, WithoutMarksItsReadsSayTheExposure) {
    const auto global = parse(frame(kGlobalFrame, kCorners, kReads)).data.images.at(0);
    EXPECT_EQ(to_us(global.exposure_begin), 120) << "with the last reset read";
    EXPECT_EQ(to_us(global.exposure_end), 200) << "to the first signal read";
    const std::vector<Read> in_turn{{110, kResetColumn, {400, 400}},
                                    {140, kSignalColumn, {350, 300}},
                                    {150, kResetColumn, {400, 400}},
                                    {180, kSignalColumn, {250, 200}}};
    const auto rolling = parse(frame(kRollingFrame, kCorners, in_turn)).data.images.at(0);
    EXPECT_EQ(to_us(rolling.exposure_begin), 110) << "with the first reset read";
    EXPECT_EQ(to_us(rolling.exposure_end), 140);
}

TEST(DavisFrame, ARegionEndsWithTheSensor) {
    const auto parsed = parse(frame(kGlobalFrame, {238, 178, 300, 300}, kReads));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.data.images[0].x0, 238);
    EXPECT_EQ(parsed.data.images[0].pixels.width(), 2);
    EXPECT_EQ(parsed.data.images[0].pixels.height(), 2);
}

TEST(DavisFrame, ReadsThatAreTooFewLoseItAndTheNextIsWhole) {
    const Words good = frame(kGlobalFrame, kCorners, kReads);
    const auto image = parse(good).data.images.at(0);
    for (std::size_t column = 0; column < kReads.size(); ++column)
        for (const bool all_of_it : {true, false}) {
            std::vector<Read> reads = kReads;
            if (all_of_it)
                reads.erase(reads.begin() + std::ptrdiff_t(column));
            else
                reads[column].samples.pop_back();
            Words words = frame(kGlobalFrame, kCorners, reads);
            words.insert(words.end(), {1U << 12 | 0U, 0x7001});  // a row, a wrap
            words.insert(words.end(), good.begin(), good.end());
            const auto parsed = parse(words);
            ASSERT_EQ(parsed.data.images.size(), 1U) << column << all_of_it;
            EXPECT_EQ(parsed.data.images[0].pixels, image.pixels);
            EXPECT_EQ(to_us(parsed.data.images[0].exposure_begin), 32768 + 120);
            EXPECT_EQ(to_us(parsed.data.images[0].exposure_end), 32768 + 200);
            EXPECT_EQ(parsed.damaged[DamageReason::bad_record], 1U);
        }
}

TEST(DavisFrame, ReadsThatAreTooManyAreNoneOfIt) {
    const auto image = parse(frame(kGlobalFrame, kCorners, kReads)).data.images.at(0);
    std::vector<Read> reads = kReads;
    for (Read& read : reads) read.samples.push_back(17);
    EXPECT_EQ(parse(frame(kGlobalFrame, kCorners, reads)).data.images.at(0).pixels, image.pixels);
    reads = kReads;
    reads.push_back(kReads.back());
    EXPECT_EQ(parse(frame(kGlobalFrame, kCorners, reads)).damaged[DamageReason::bad_record], 1U);
    Words words = frame(kGlobalFrame, kCorners, kReads);
    words.insert(words.begin() + 10, {roi_high(9), adc(5)});  // behind the region, in no column
    EXPECT_EQ(parse(words).data.images.at(0).pixels, image.pixels);
}

TEST(DavisFrame, ARegionThatChangesIsThatOfEachFrame) {
    constexpr std::array<int, 4> kOtherCorners{100, 50, 101, 51};
    Words words = frame(kGlobalFrame, kCorners, kReads);
    words.push_back(0x7001);
    const Words other = frame(kGlobalFrame, kOtherCorners, kReads);
    words.insert(words.end(), other.begin(), other.end());
    const auto parsed = parse(words);
    ASSERT_EQ(parsed.data.images.size(), 2U);
    EXPECT_EQ(parsed.data.images[0].x0, 10);
    EXPECT_EQ(parsed.data.images[1].x0, 100);
    EXPECT_EQ(parsed.data.images[1].y0, 50);
    EXPECT_EQ(parsed.data.images[1].pixels, parsed.data.images[0].pixels);
}

TEST(DavisFrame, OneThatDoesNotEndBeforeTheNextIsCounted) {
    for (const std::size_t torn_behind : {5U, 12U, 24U}) {
        Words words = frame(kGlobalFrame, kCorners, kReads);
        words.resize(torn_behind);
        words.push_back(0x7001);
        const Words next = frame(kGlobalFrame, kCorners, kReads);
        words.insert(words.end(), next.begin(), next.end());
        const auto parsed = parse(words);
        ASSERT_EQ(parsed.data.images.size(), 1U) << torn_behind;
        EXPECT_EQ(parsed.data.images[0].pixels(1, 1), wide(400)) << torn_behind;
        EXPECT_EQ(parsed.damaged[DamageReason::bad_record], 1U) << torn_behind;
        EXPECT_EQ(parsed.damaged.total(), 1U) << torn_behind;
    }
}

TEST(DavisFrame, AColumnEndsOnce) {
    Words words = frame(kGlobalFrame, kCorners, kReads);
    const auto end = std::find(words.begin(), words.end(), special(kColumnEnd));
    words.insert(end, special(kColumnEnd));
    EXPECT_EQ(parse(words).data.images.size(), 1U);
}

TEST(DavisFrame, BehindALossItWaitsForATime) {
    DavisParser parser{davis240()};
    Batch data;
    parser.parse(bytes_of({time(50)}), data);
    parser.resync();
    for (const bool with_time : {false, true}) {
        Words begun = frame(kGlobalFrame, kCorners, kReads);
        std::erase_if(begun, [&](std::uint16_t w) { return !with_time && w == time(100); });
        parser.parse(bytes_of(begun), data);
        EXPECT_EQ(data.images.size(), with_time ? 1U : 0U);
        parser.resync();
    }
}

/// Marks in an order that no camera's should have.
TEST(DavisFrame, AnExposureDoesNotEndBeforeItBegins) {
    Words words = frame(kGlobalFrame, kCorners, kReads);
    words.insert(words.end() - 1, {time(300), special(kExposureStart), time(310)});
    const auto image = parse(words).data.images.at(0);
    EXPECT_EQ(to_us(image.exposure_begin), 300);
    EXPECT_EQ(to_us(image.exposure_end), 310);
}

/// A reset of the camera's clock, or a loss.
TEST(DavisFrame, DoesNotGoOnBehindAResetOrALoss) {
    EXPECT_TRUE(parse_cut_off(frame(kGlobalFrame, kCorners, kReads), 20).images.empty());
}

}  // namespace
}  // namespace eventide::davis_words
