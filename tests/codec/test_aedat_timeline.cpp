// Times of AEDAT 1 and 2: wraps, damage, resets.
#include "tests/codec/aedat2_words.h"

namespace eventide::aedat2 {
namespace {

TEST(Aedat2, TimeGoesOnThroughWraps) {
    constexpr std::int64_t kHalf = std::int64_t(1) << 31;
    // Through 2^31 as an overflow to negative, through 2^32, and as a counter of 31 bits.
    for (const std::int64_t wrap : {kHalf, 2 * kHalf}) {
        const Parsed parsed =
            parse_whole(davis(), join({dvs(1, 1, true, wrap - 2), dvs(1, 1, true, wrap - 1),
                                       dvs(1, 1, true, wrap), dvs(1, 1, true, wrap + 5)}));
        ASSERT_EQ(parsed.data.events.size(), 4U);
        EXPECT_EQ((parsed.data.events[3].t - parsed.data.events[0].t).count(), 7);
        EXPECT_EQ(parsed.damage.total(), 0U);
    }
    const Parsed counter = parse_whole(
        davis(), join({dvs(1, 1, true, kHalf - 3), dvs(1, 1, true, 2), dvs(1, 1, true, 4)}));
    ASSERT_EQ(counter.data.events.size(), 3U);
    EXPECT_EQ(to_us(counter.data.events[1].t), kHalf + 2);
    EXPECT_EQ(to_us(counter.data.events[2].t), kHalf + 4);
}

TEST(Aedat2, AStepBackIsCountedAndAResetIsFollowed) {
    const Parsed back = parse_whole(
        davis(), join({dvs(1, 1, true, 100), dvs(1, 1, true, 90), dvs(1, 1, true, 110)}));
    EXPECT_EQ(back.data.events.size(), 2U);
    EXPECT_EQ(back.damage[DamageReason::time_backwards], 1U);

    std::vector<Bytes> words{dvs(1, 1, true, 5'000'000)};
    for (int i = 0; i < 100; ++i) words.push_back(dvs(1, 1, true, i * 1000));
    const Parsed reset = parse_whole(davis(), join(words));
    EXPECT_EQ(reset.damage[DamageReason::time_backwards],
              std::uint64_t(AedatTimeline::kResetRecords));
    EXPECT_EQ(reset.data.events.size(), 1U + 100 - AedatTimeline::kResetRecords);
    EXPECT_EQ(reset.data.triggers.size(), 1U);
    EXPECT_EQ(to_us(reset.data.events.back().t),
              5'000'000 + 1000 * (99 - AedatTimeline::kResetRecords));
}

TEST(Aedat2, AFlippedBitInATimeCostsOneRecord) {
    const Parsed parsed =
        parse_whole(davis(), join({dvs(1, 1, true, 100), dvs(1, 1, true, 110 | 1 << 29),
                                   dvs(1, 1, true, 120), dvs(1, 1, true, 130)}));
    EXPECT_EQ(parsed.data.events.size(), 3U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    EXPECT_EQ(parsed.clock, from_us(130));
}

}  // namespace
}  // namespace eventide::aedat2
