// The clock of iniVation's cameras: what their words say, and what the host's clock adds after a
// loss. (A minute of losses: tests/drivers/test_lossy_clock.cpp.)
#include "src/codec/inivation/inivation_clock.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

constexpr std::int64_t kSecond = 1'000'000, kMs = 1'000;  // us

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
    camera.clock.reset(camera.damage);
    EXPECT_EQ(camera.clock.us(), kSecond + 1'000);
    EXPECT_TRUE(camera.clock.timestamp(5, camera.damage));
    EXPECT_EQ(camera.clock.us(), kSecond + 1'005);
    EXPECT_EQ(camera.damage.total(), 0U);
}

/// Of wraps 12 bits are counted, some 134 s.
TEST(IniVationClock, ADeviceThatResetItselfWhileNobodyReadGoesOnByTheHostsClock) {
    Camera camera;
    camera.packet(0, 1'000);
    camera.packet(10 * kMs, 11'000);
    camera.packet(200 * kSecond, 12'000);  // still from before
    EXPECT_EQ(camera.clock.us(), 12'000);
    camera.packet(200 * kSecond + kMs);
    camera.clock.reset(camera.damage);
    EXPECT_TRUE(camera.clock.timestamp(5, camera.damage));
    EXPECT_NEAR(double(camera.clock.us()), 200e6 + 2e3, 200e6 * 250e-6) << "but for the drift";
    EXPECT_EQ(camera.corrected(), 1U);
    camera.packet(200 * kSecond + 2 * kMs);
    camera.clock.reset(camera.damage);  // by another's hand
    EXPECT_EQ(camera.corrected(), 1U);
}

/// However little time has passed by the host's clock, which was late with the packet before.
TEST(IniVationClock, ATimeThatWouldGoBackTellsOfALostWrap) {
    Camera camera;
    camera.packet(0, 10'000);
    camera.clock.forget();
    camera.packet(1'000, 11'000);
    camera.clock.forget();
    EXPECT_TRUE(camera.packet(1'100, 5'000));
    EXPECT_EQ(camera.clock.us(), Camera::kWrap + 5'000);
    EXPECT_EQ(camera.damage[DamageReason::time_backwards], 0U);
}

/// The first is taken for 15 ms later than any packet can tell.
TEST(IniVationClock, AGuessIsNoMeasureForTheNext) {
    Camera camera;
    camera.packet(0, 0);
    camera.packet(10 * kMs, 10'000);
    camera.clock.forget();
    camera.packet(60 * kMs, 10'000);
    EXPECT_EQ(camera.clock.us(), 2 * Camera::kWrap + 10'000);
    camera.clock.forget();
    camera.packet(100 * kMs, 20'000);
    EXPECT_EQ(camera.clock.us(), 2 * Camera::kWrap + 20'000);
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

TEST(IniVationClock, WhatIsTakenBackIsForgottenByALossAtTheSameTime) {
    Camera camera;
    guess_too_much(camera);
    camera.packet(61 * kMs);
    camera.clock.wrap(1, camera.damage);
    camera.clock.timestamp(14'000, camera.damage);
    camera.clock.forget();
    camera.packet(62 * kMs, 14'500);
    EXPECT_EQ(camera.corrected(), 2U) << "the guess, and that it was one";
    EXPECT_EQ(camera.clock.us(), 2 * Camera::kWrap + 14'000);
}

/// What the camera's own words say is not, however early they seem.
TEST(IniVationClock, NoMoreIsTakenBackThanWasGuessed) {
    Camera camera;
    guess_too_much(camera);
    camera.packet(61 * kMs);
    camera.clock.wrap(3, camera.damage);
    camera.packet(62 * kMs);
    camera.clock.wrap(2, camera.damage);
    EXPECT_EQ(camera.clock.us(), (3 + 2) * Camera::kWrap);
    EXPECT_EQ(camera.corrected(), 2U);
}

TEST(IniVationClock, AResetEndsTheDoubt) {
    Camera camera;
    guess_too_much(camera);
    camera.clock.reset(camera.damage);
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
    camera.clock.reset(camera.damage);
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

/// A second loss takes a wrap with it that does not show at once, as the packet before it was late.
TEST(IniVationClock, TheDoubtLastsAWhileAfterTheLastLoss) {
    constexpr std::int64_t kWrap = Camera::kWrap;
    Camera camera;
    camera.packet(0, 0);
    camera.packet(10 * kMs, 10'000);
    camera.clock.forget();
    camera.packet(11 * kMs, 11'000);
    for (int wrap = 1; wrap <= 6; ++wrap) {
        camera.packet(wrap * kWrap);
        camera.clock.wrap(1, camera.damage);
    }
    camera.packet(6 * kWrap + 31 * kMs, 1'000);
    camera.clock.forget();
    camera.packet(7 * kWrap + 2 * kMs, 2'000);
    EXPECT_EQ(camera.clock.us(), 6 * kWrap + 2'000);
    for (int wrap = 8; wrap <= 30; ++wrap) {
        camera.packet(wrap * kWrap);
        camera.clock.wrap(1, camera.damage);
    }
    EXPECT_EQ(camera.clock.us(), 30 * kWrap);
    EXPECT_EQ(camera.corrected(), 1U);
}

/// Between losses, while it still looks for wraps that are missing.
TEST(IniVationClock, PacketsThatTellNoTimeAreNotLate) {
    Camera camera;
    camera.packet(0, 0);
    camera.packet(10 * kMs, 10'000);
    camera.clock.forget();
    camera.packet(11 * kMs, 11'000);
    camera.clock.forget();
    camera.packet(200 * kMs);
    camera.clock.wrap(6, camera.damage);
    camera.packet(320 * kMs);
    camera.clock.wrap(3, camera.damage);
    camera.clock.timestamp(25'000, camera.damage);
    for (int ms = 420; ms < 800; ms += 100) camera.packet(ms * kMs);
    camera.packet(800 * kMs);
    camera.clock.wrap(15, camera.damage);
    EXPECT_EQ(camera.clock.us(), 24 * Camera::kWrap);
    EXPECT_EQ(camera.corrected(), 0U);
}

}  // namespace
}  // namespace eventide
