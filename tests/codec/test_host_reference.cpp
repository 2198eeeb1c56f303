// How far a device's clock is ahead of the host's, as packets that are more or less late tell it.
#include "src/codec/inivation/host_reference.h"

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

}  // namespace
}  // namespace eventide
