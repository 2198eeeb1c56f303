// Times of AEDAT 1 and 2: wraps, damage, resets.
#include "tests/codec/aedat2_words.h"

#include <gmock/gmock.h>

namespace eventide::aedat2 {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Stamps = std::vector<std::int32_t>;
constexpr std::int32_t kSecond = 1'000'000;  // us

struct Told {
    std::vector<std::int64_t> times, resets;  // us
    std::uint64_t bad = 0;
};

Told told_by(const Stamps& stamps) {
    AedatTimeline timeline;
    Told told;
    Damage damage;
    const auto take = [&](const AedatRecord&, std::int64_t t) { told.times.push_back(t); };
    const auto reset = [&](std::int64_t t) { told.resets.push_back(t); };
    for (const std::int32_t stamp : stamps) timeline.push({0, stamp}, damage, take, reset);
    timeline.finish(take);
    told.bad = damage.total();
    return told;
}

/// n stamps from `first` on.
Stamps run(std::int32_t first, std::int32_t step, int n) {
    Stamps stamps;
    for (int i = 0; i < n; ++i) stamps.push_back(first + i * step);
    return stamps;
}

Stamps operator+(Stamps a, const Stamps& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

TEST(AedatTimeline, TimeGoesOnThroughWraps) {
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

TEST(AedatTimeline, AStepBackIsCountedAndAResetIsFollowed) {
    const Parsed back = parse_whole(
        davis(), join({dvs(1, 1, true, 100), dvs(1, 1, true, 90), dvs(1, 1, true, 110)}));
    EXPECT_EQ(back.data.events.size(), 2U);
    EXPECT_EQ(back.damage[DamageReason::time_backwards], 1U);

    std::vector<Bytes> words{dvs(1, 1, true, 5'000'000)};
    for (int i = 0; i < 100; ++i) words.push_back(dvs(1, 1, true, i * 1000));
    const Parsed reset = parse_whole(davis(), join(words));
    EXPECT_EQ(reset.damage.total(), 0U);
    EXPECT_EQ(reset.data.events.size(), 1U + 100) << "none is lost";
    EXPECT_EQ(reset.data.triggers,
              (std::vector{Trigger{from_us(5'000'000), Trigger::Kind::timestamp_reset, 0}}));
    EXPECT_EQ(to_us(reset.data.events[1].t), 5'000'000);
    EXPECT_EQ(to_us(reset.data.events.back().t), 5'000'000 + 99 * 1000);
}

TEST(AedatTimeline, AResetTakesSamplesAndImagesAlongWithTheEvents) {
    std::vector<Bytes> words{dvs(1, 1, true, 5'000'000)};
    for (unsigned measure = 0; measure < 7; ++measure) words.push_back(imu(measure, 1, 10));
    for (const bool is_signal : {false, true})
        for (int x = 0; x < 2; ++x)
            words.push_back(aps(is_signal, x, 0, 500, 20 + 2 * int(is_signal) + x, 1));
    words.push_back(record(1U << 10, 30));
    for (int i = 0; i < 40; ++i) words.push_back(record(1U << 12, 100 + i));
    const Parsed parsed = parse_whole(davis(2, 1), join(words));
    ASSERT_EQ(parsed.data.imu.size(), 1U);
    EXPECT_EQ(parsed.data.imu[0].t, from_us(5'000'000));
    ASSERT_EQ(parsed.data.images.size(), 1U);
    EXPECT_GT(parsed.data.images[0].t, from_us(5'000'000));
    ASSERT_EQ(parsed.data.triggers.size(), 2U);
    EXPECT_EQ(parsed.data.triggers[1].t, from_us(5'000'020));
    expect_same_for_any_split(davis(2, 1), join(words));
}

TEST(AedatTimeline, AResetIsFollowedThroughJitterAsWell) {
    Stamps stamps{kSecond};
    for (int i = 0; i < 40; ++i) stamps.push_back(100 + i - 2 * (i % 2));
    const Told told = told_by(stamps);
    EXPECT_THAT(told.resets, ElementsAre(1'000'000));
    EXPECT_EQ(told.times[1], 1'000'000);
    EXPECT_EQ(told.times.back(), 1'000'037);
}

/// They may come later than the events around them.
TEST(AedatTimeline, RecordsInThePastThatAreNoResetComeOutInTheirPlace) {
    EXPECT_THAT(told_by({kSecond, 3, 4, kSecond + 1}).times,
                ElementsAre(1'000'000, 3, 4, 1'000'001));
    EXPECT_THAT(told_by({kSecond, 3, 2, kSecond + 1}).times,
                ElementsAre(1'000'000, 3, 2, 1'000'001));
    EXPECT_THAT(told_by({kSecond, 3}).times, ElementsAre(1'000'000, 3)) << "at the end, too";
}

TEST(AedatTimeline, AFlippedBitInATimeCostsOneRecord) {
    const Parsed parsed =
        parse_whole(davis(), join({dvs(1, 1, true, 100), dvs(1, 1, true, 110 | 1 << 29),
                                   dvs(1, 1, true, 120), dvs(1, 1, true, 130)}));
    EXPECT_EQ(parsed.data.events.size(), 3U);
    EXPECT_EQ(parsed.damage[DamageReason::bad_record], 1U);
    EXPECT_EQ(parsed.clock, from_us(130));
}

TEST(AedatTimeline, ATenthOfASecondIsNoLeapAndMoreIsOne) {
    EXPECT_THAT(told_by({0, 100'000, 5}).times, ElementsAre(0, 100'000, 5));
    EXPECT_EQ(told_by({0, 100'000, 5}).bad, 0U);
    EXPECT_THAT(told_by({0, 100'001, 5}).times, ElementsAre(0, 5));
    EXPECT_EQ(told_by({0, 100'001, 5}).bad, 1U);
}

TEST(AedatTimeline, ALeapIsConfirmedByARecordOfItsOwnTime) {
    const Told told = told_by({0, 5 * kSecond, 5 * kSecond, 5 * kSecond + 1});
    EXPECT_THAT(told.times, ElementsAre(0, 5'000'000, 5'000'000, 5'000'001));
    EXPECT_EQ(told.bad, 0U);
}

/// Quarter of an hour after the first recording's beginning the second one's follows in its file.
TEST(AedatTimeline, AFallOfLessThanHalfItsRangeIsNoWrap) {
    const Told told = told_by(run(1000 * kSecond, 1, 3) + run(0, 1, 100));
    EXPECT_THAT(told.resets, ElementsAre(1'000'000'002));
    EXPECT_EQ(told.times.back(), 1'000'000'002 + 99);
}

TEST(AedatTimeline, AClockThatIsSetBackBehindItsOverflowIsNoWrapEither) {
    const Told told = told_by(run(INT32_MIN + 10, 1, 3) + run((1 << 30) - kSecond, 1, 100));
    EXPECT_THAT(told.resets, ElementsAre(std::int64_t{INT32_MIN} + 12));
}

TEST(AedatTimeline, AClockThatIsSetBackMayTellATimeManyTimes) {
    Stamps stamps{100 * kSecond};
    for (int i = 0; i < 100; ++i) stamps.push_back(i / 4);
    EXPECT_THAT(told_by(stamps).resets, ElementsAre(100'000'000));
}

TEST(AedatTimeline, JitterIsNoResetHoweverLongItLasts) {
    constexpr auto kJitter = std::int32_t(AedatTimeline::kJitter);
    EXPECT_THAT(told_by(Stamps{kSecond} + run(kSecond - kJitter, 0, 100)).resets, IsEmpty());
    EXPECT_THAT(told_by(Stamps{kSecond} + run(kSecond - kJitter - 1, 0, 100)).resets,
                ElementsAre(1'000'000));
}

TEST(AedatTimeline, RecordsInThePastAmongOthersAreNoReset) {
    Stamps stamps;
    for (int i = 0; i < 100; ++i) stamps = stamps + Stamps{kSecond + i, i};
    EXPECT_THAT(told_by(stamps).resets, IsEmpty());
}

TEST(AedatTimeline, AClockThatIsSetBackPausesForAMinuteAtMost) {
    const Stamps before{-kSecond};
    EXPECT_EQ(told_by(before + run(INT32_MIN, 60 * kSecond, 35)).resets.size(), 1U);
    EXPECT_THAT(told_by(before + run(INT32_MIN, 60 * kSecond + 1, 35)).resets, IsEmpty());
}

}  // namespace
}  // namespace eventide::aedat2
