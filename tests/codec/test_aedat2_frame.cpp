// AEDAT 2.0: images from the reads of their pixels.
#include "tests/codec/aedat2_words.h"

namespace eventide::aedat2 {
namespace {

TEST(Aedat2, FramesAreTheDifferenceOfTwoReads) {
    const Parsed parsed = parse_whole(davis(3, 4), global_frame(0, 0, 3, 4, 100));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    const ReferenceImage& image = parsed.data.images[0];
    ASSERT_EQ(image.pixels.height(), 4);
    ASSERT_EQ(image.pixels.width(), 3);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 3; ++x) EXPECT_EQ(image.pixels(y, x), of_16_bits(100 + x + 10 * y));
    // 12 resets at 100..111, 12 signals at 112..123.
    EXPECT_EQ(image.exposure_begin, from_us(111));
    EXPECT_EQ(image.exposure_end, from_us(112));
    EXPECT_EQ(image.t, from_us(111));
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat2, ARollingShutterExposesFromTheFirstReset) {
    // Columns 0, 1: reset 0, reset 1 while signal 0 is read, signal 1.
    const Parsed parsed =
        parse_whole(davis(2, 1), join({aps(false, 0, 0, 600, 10, 1), aps(true, 0, 0, 500, 30, 1),
                                       aps(false, 1, 0, 600, 31, 1), aps(true, 1, 0, 400, 50, 1)}));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.data.images[0].exposure_begin, from_us(10));
    EXPECT_EQ(parsed.data.images[0].exposure_end, from_us(30));
    EXPECT_EQ(parsed.data.images[0].t, from_us(20));
    EXPECT_EQ(parsed.data.images[0].pixels(0, 1), of_16_bits(200));
}

TEST(Aedat2, OverexposedPixelsAreWhite) {
    const Parsed parsed =
        parse_whole(davis(2, 1), join({aps(false, 0, 0, 100, 1, 1), aps(false, 1, 0, 600, 2, 1),
                                       aps(true, 0, 0, 90, 3, 1), aps(true, 1, 0, 0, 4, 1)}));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.data.images[0].pixels(0, 0), 65535);
    EXPECT_EQ(parsed.data.images[0].pixels(0, 1), 65535);
}

/// Its converter uses half its range, and recorders keep the numbers as they come.
TEST(Aedat2, FramesOfADavis240HaveTheirWholeRange) {
    const MakeParser davis240 = [] {
        return std::make_unique<Aedat2Parser>(Aedat2Sensor::davis240, 3, 1);
    };
    const Parsed parsed = parse_whole(
        davis240,
        join({aps(false, 0, 0, 192, 1, 1), aps(false, 1, 0, 300, 2, 1), aps(false, 2, 0, 191, 3, 1),
              aps(true, 0, 0, 92, 4, 1), aps(true, 1, 0, 0, 5, 1), aps(true, 2, 0, 180, 6, 1)}));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.data.images[0].pixels(0, 0), of_16_bits(2 * 100));
    EXPECT_EQ(parsed.data.images[0].pixels(0, 1), 65535) << "at the end of the scale";
    EXPECT_EQ(parsed.data.images[0].pixels(0, 2), 65535) << "bright while it was reset";
}

TEST(Aedat2, FramesOfARegionAreCompleteWhenTheyFillIt) {
    const Bytes one = global_frame(1, 1, 2, 3, 100), two = global_frame(1, 1, 2, 3, 200);
    const Parsed parsed = parse_whole(davis(5, 4), join({one, two}));
    ASSERT_EQ(parsed.data.images.size(), 2U);
    EXPECT_EQ(parsed.data.images[1].x0, 1);
    EXPECT_EQ(parsed.data.images[1].y0, 1);
    EXPECT_EQ(parsed.data.images[1].pixels.height(), 3);
    EXPECT_EQ(parsed.damage.total(), 0U);
}

TEST(Aedat2, IncompleteFramesAreLeftOutAndCounted) {
    Bytes holed = global_frame(0, 0, 3, 4, 100);
    holed.erase(holed.begin() + 8 * 5, holed.begin() + 8 * 6);
    const Parsed parsed =
        parse_whole(davis(3, 4), join({holed, global_frame(0, 0, 3, 4, 200), holed}));
    EXPECT_EQ(parsed.data.images.size(), 1U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U);
}

TEST(Aedat2, FramesThatMissReadsOfOneKindAreIncomplete) {
    const Bytes next = global_frame(0, 0, 3, 4, 200);
    for (const std::size_t missing : {3U, 12U + 3U}) {  // a reset, a signal
        Bytes holed = global_frame(0, 0, 3, 4, 100);
        holed.erase(holed.begin() + std::ptrdiff_t(8 * missing),
                    holed.begin() + std::ptrdiff_t(8 * (missing + 1)));
        const Parsed parsed = parse_whole(davis(3, 4), join({holed, next}));
        EXPECT_EQ(parsed.data.images.size(), 1U) << missing;
        EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U) << missing;
    }
    // Two pixels with one between them that was not read.
    const auto both = [](int x, std::int64_t t) {
        return join({aps(false, x, 0, 600, t, 1), aps(true, x, 0, 500, t + 1, 1)});
    };
    const Parsed parsed =
        parse_whole(davis(5, 1), join({both(0, 10), both(2, 20), both(0, 30), both(2, 40)}));
    EXPECT_TRUE(parsed.data.images.empty());
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U);
}

TEST(Aedat2, ARegionThatIsSeenOnceMayBeAFrameCutShort) {
    const Parsed parsed = parse_whole(davis(5, 4), global_frame(1, 1, 2, 3, 100));
    EXPECT_TRUE(parsed.data.images.empty());
    EXPECT_EQ(parsed.damage[DamageReason::truncated], 1U);
}

TEST(Aedat2, AGlobalShutterBehindARollingOneIsOne) {
    const Bytes rolling = join({aps(false, 0, 0, 600, 10, 1), aps(true, 0, 0, 500, 30, 1),
                                aps(false, 1, 0, 600, 31, 1), aps(true, 1, 0, 400, 50, 1)}),
                global = join({aps(false, 0, 0, 600, 110, 1), aps(false, 1, 0, 600, 120, 1),
                               aps(true, 0, 0, 500, 130, 1), aps(true, 1, 0, 400, 150, 1)});
    const Parsed parsed = parse_whole(davis(2, 1), join({rolling, global}));
    ASSERT_EQ(parsed.data.images.size(), 2U);
    EXPECT_EQ(parsed.data.images[1].exposure_begin, from_us(120));
    EXPECT_EQ(parsed.data.images[1].exposure_end, from_us(130));
}

}  // namespace
}  // namespace eventide::aedat2
