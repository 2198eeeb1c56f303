// The clock of iniVation's cameras: what their words say, and what the host's clock adds after a
// loss. (A minute of losses: tests/drivers/test_lossy_clock.cpp.)
#include "src/codec/inivation/inivation_clock.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

constexpr std::int64_t kSecond = 1'000'000, kMs = 1'000;  // us

TEST(HostReference, ThePacketThatCameSoonestBoundsTheOthers) {
    HostReference reference;
    reference.begin(1000, 1500);
    EXPECT_EQ(reference.latest(2000), 1500);
    reference.see(3000, 3100, false);
    EXPECT_EQ(reference.latest(5000), 4900) << "sooner than the first";
    reference.see(4000, 4900, false);
    EXPECT_NEAR(double(reference.latest(5000)), 4900, 1) << "a late one changes nothing";
}

/// Each may be 100 ppm off.
TEST(HostReference, FallsBackNoFasterThanTwoClocksDrift) {
    constexpr std::int64_t kStart = 1'000 * kSecond;
    HostReference reference;
    reference.begin(0, kStart);
    for (int second = 1; second <= 10; ++second)
        reference.see(second * kSecond - 500 * kMs, kStart + second * kSecond, false);
    EXPECT_NEAR(double(reference.latest(kStart + 10 * kSecond)), 10 * kSecond - 2 * kMs, 1);
    reference.see(20 * kSecond - 4 * kMs, kStart + 20 * kSecond, false);
    EXPECT_NEAR(double(reference.latest(kStart + 20 * kSecond)), 20 * kSecond - 4 * kMs, 1)
        << "a camera that is as slow as may be comes on time";
}

TEST(HostReference, ATimeInDoubtMovesItNoFasterThanDrift) {
    HostReference sure, in_doubt;
    sure.begin(0, 0);
    in_doubt.begin(0, 0);
    sure.see(kSecond + 30 * kMs, kSecond, false);
    in_doubt.see(kSecond + 30 * kMs, kSecond, true);
    EXPECT_EQ(sure.latest(kSecond), kSecond + 30 * kMs);
    EXPECT_EQ(in_doubt.latest(kSecond), kSecond + 200);
}

/// A camera of 15 bits, whose words come in packets.
class Camera {
public:
    void packet(std::int64_t arrives_us) {
        clock.arrives(HostTime{std::chrono::microseconds{arrives_us}}, damage);
    }
    /// A packet with one time.
    bool packet(std::int64_t arrives_us, std::uint16_t low) {
        packet(arrives_us);
        return clock.timestamp(low, damage);
    }
    std::uint64_t corrected() const { return damage[DamageReason::time_corrected]; }

    static constexpr std::int64_t kWrap = IniVationClock<15>::kWrapUs;
    IniVationClock<15> clock;
    Damage damage;
};

TEST(IniVationClock, ATimeMayBeToldTwiceAndNoneBeforeIt) {
    Camera camera;
    EXPECT_TRUE(camera.packet(0, 5));
    EXPECT_TRUE(camera.packet(0, 5));
    EXPECT_FALSE(camera.packet(0, 4));
    EXPECT_EQ(camera.clock.us(), 5);
    EXPECT_EQ(camera.damage[DamageReason::time_backwards], 1U);
    EXPECT_EQ(camera.damage.total(), 1U);
}

TEST(IniVationClock, AWrapOfNothingIsDamage) {
    Camera camera;
    camera.packet(0, 5);
    camera.clock.wrap(0, camera.damage);
    EXPECT_EQ(camera.clock.us(), 5);
    EXPECT_EQ(camera.damage[DamageReason::bad_record], 1U);
    camera.clock.wrap(2, camera.damage);
    EXPECT_EQ(camera.clock.us(), 2 * Camera::kWrap);
}

TEST(IniVationClock, LostWrapsAreThoseThatBringTheTimeNearestToTheHosts) {
    for (const std::int64_t low : {1'000, 16'000, 32'000})
        for (const std::int64_t wraps : {0, 1, 7})
            for (const std::int64_t late : {-12 * kMs, 0 * kMs, 12 * kMs}) {
                Camera camera;
                camera.packet(kSecond, 500);
                camera.clock.forget();
                const std::int64_t now = wraps * Camera::kWrap + low;
                if (now - 500 + late < 0) continue;
                camera.packet(kSecond + now - 500 + late, std::uint16_t(low));
                EXPECT_EQ(camera.clock.us(), now) << low << ", " << wraps << ", " << late;
                EXPECT_EQ(camera.corrected(), wraps > 0 ? 1U : 0U);
            }
}

TEST(IniVationClock, ALostWrapWhoseTimesComeInAWrapWordIsFoundToo) {
    Camera camera;
    camera.packet(0, 500);
    camera.clock.forget();
    camera.packet(4 * Camera::kWrap - 500);
    camera.clock.wrap(1, camera.damage);
    EXPECT_EQ(camera.clock.us(), 4 * Camera::kWrap);
    EXPECT_EQ(camera.corrected(), 1U);
}

TEST(IniVationClock, ADeviceThatComesBackAndCountsFromZeroGoesOnByTheHostsClock) {
    Camera camera;
    camera.packet(0, 1'000);
    camera.clock.forget();
    camera.packet(kSecond);
    camera.clock.reset();
    EXPECT_EQ(camera.clock.us(), kSecond + 1'000);
    EXPECT_TRUE(camera.clock.timestamp(5, camera.damage));
    EXPECT_EQ(camera.clock.us(), kSecond + 1'005);
    EXPECT_EQ(camera.damage.total(), 0U);
}

/// A packet held up for half a wrap and more makes it guess one too many.
void guess_too_much(Camera& camera) {
    camera.packet(0, 0);
    camera.packet(10 * kMs, 10'000);
    camera.clock.forget();
    camera.packet(60 * kMs, 20'000);
    ASSERT_EQ(camera.clock.us(), Camera::kWrap + 20'000);
}

TEST(IniVationClock, AGuessThatProvesImpossibleIsTakenBackAndTimeWaits) {
    Camera camera;
    guess_too_much(camera);
    camera.packet(61 * kMs);
    camera.clock.wrap(1, camera.damage);
    constexpr std::int64_t kTooEarly = 2 * Camera::kWrap + 14'000;
    EXPECT_TRUE(camera.clock.timestamp(14'000, camera.damage));
    EXPECT_EQ(camera.clock.us(), kTooEarly);
    EXPECT_TRUE(camera.packet(62 * kMs, 14'500));
    EXPECT_EQ(camera.corrected(), 2U);
    EXPECT_EQ(camera.clock.us(), kTooEarly) << "it never steps back";
    camera.clock.wrap(1, camera.damage);
    EXPECT_TRUE(camera.packet(96 * kMs, 14'100));
    EXPECT_EQ(camera.clock.us(), kTooEarly + 100) << "it goes on where the camera caught up";
    EXPECT_EQ(camera.damage.total(), camera.corrected());
}

TEST(IniVationClock, AResetEndsTheDoubt) {
    Camera camera;
    guess_too_much(camera);
    camera.clock.reset();
    camera.packet(61 * kMs, 100);
    camera.packet(62 * kMs, 30'000);
    camera.packet(63 * kMs, 30'500);
    EXPECT_EQ(camera.clock.us(), Camera::kWrap + 20'000 + 30'500);
    EXPECT_EQ(camera.corrected(), 1U) << "the guess";
}

/// The last packet before an unplugging was 30 ms late, and time went on from it: it is that much
/// behind the one before, and so is all that follows.
TEST(IniVationClock, AfterAResetWhatWasBeforeSaysNothingOfDelays) {
    Camera camera;
    camera.packet(0, 0);
    camera.packet(10 * kMs, 10'000);
    camera.packet(60 * kMs, 30'000);
    camera.clock.forget();
    camera.packet(kSecond);
    camera.clock.reset();
    camera.packet(kSecond + 10 * kMs, 10'000);
    camera.clock.forget();
    camera.packet(kSecond + 11 * kMs, 11'000);
    for (int wrap = 1; wrap < 20; ++wrap) {
        camera.packet(kSecond + wrap * Camera::kWrap);
        camera.clock.wrap(1, camera.damage);
    }
    EXPECT_EQ(camera.clock.us(), kSecond - 30 * kMs + 19 * Camera::kWrap);
    EXPECT_EQ(camera.corrected(), 0U);
}

/// The last packet before a loss was 30 ms late, the first behind it was not: two wraps passed, and
/// one seems to have. Every packet is late without it.
TEST(IniVationClock, AWrapThatStaysMissingIsAddedAfterAWhile) {
    Camera camera;
    camera.packet(0, 0);
    camera.packet(10 * kMs, 10'000);
    camera.packet(60 * kMs, 30'000);
    camera.clock.forget();
    camera.packet(2 * Camera::kWrap + 5'000, 5'000);
    EXPECT_EQ(camera.clock.us(), Camera::kWrap + 5'000);
    for (int wrap = 3; wrap < 20; ++wrap) {
        camera.packet(wrap * Camera::kWrap);
        camera.clock.wrap(1, camera.damage);
        EXPECT_EQ(camera.clock.us(), (wrap > 12 ? wrap : wrap - 1) * Camera::kWrap);
    }
    EXPECT_EQ(camera.corrected(), 2U);
}

TEST(IniVationClock, PacketsThatTellNoTimeAreNotLate) {
    Camera camera;
    camera.packet(0, 0);
    camera.packet(10 * kMs, 10'000);
    camera.clock.forget();
    camera.packet(11 * kMs, 11'000);
    for (int i = 1; i <= 10; ++i) camera.packet(11 * kMs + i * 100 * kMs);
    camera.clock.wrap(31, camera.damage);
    EXPECT_EQ(camera.clock.us(), 31 * Camera::kWrap);
    EXPECT_EQ(camera.corrected(), 0U);
}

}  // namespace
}  // namespace eventide
