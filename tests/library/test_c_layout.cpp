// Programs built against an earlier 1.x have these sizes and places in them.
#include <eventide/eventide.h>

#include <gtest/gtest.h>

#include <cstddef>

namespace eventide::test {
namespace {

TEST(CLayout, OfStructsThatGrowStaysAsItBegan) {
    if (sizeof(void*) != 8) GTEST_SKIP() << "these are the places on machines of 64 bits";
    EXPECT_EQ(offsetof(eventide_options, size), 32U);
    EXPECT_EQ(offsetof(eventide_options, hot_pixels), 64U);
    EXPECT_EQ(offsetof(eventide_options, threads), 88U);
    EXPECT_EQ(offsetof(eventide_options, noise_filter), 104U);
    EXPECT_EQ(offsetof(eventide_options, images), 112U);
    EXPECT_EQ(offsetof(eventide_options, lamp_flicker), 120U);
    EXPECT_EQ(offsetof(eventide_options, self_ensemble), 128U);
    EXPECT_EQ(offsetof(eventide_callbacks, warn), 24U);
    EXPECT_EQ(offsetof(eventide_recording_options, stream), 24U);
}

TEST(CLayout, OfWhatIsFilledInStaysWhole) {
    if (sizeof(void*) != 8) GTEST_SKIP() << "these are the places on machines of 64 bits";
    EXPECT_EQ(sizeof(eventide_event), 16U);
    EXPECT_EQ(sizeof(eventide_frame_size), 24U);
    EXPECT_EQ(sizeof(eventide_frame), 72U);
    EXPECT_EQ(sizeof(eventide_image), 48U);
    EXPECT_EQ(sizeof(eventide_counters), 96U);
    EXPECT_EQ(offsetof(eventide_event, on), 12U);
    EXPECT_EQ(offsetof(eventide_frame, width), 40U);
    EXPECT_EQ(offsetof(eventide_frame, intensity), 48U);
    EXPECT_EQ(offsetof(eventide_frame, gap_before), 64U);
    EXPECT_EQ(offsetof(eventide_image, x), 24U);
    EXPECT_EQ(offsetof(eventide_image, pixels), 40U);
    EXPECT_EQ(offsetof(eventide_counters, time_resets), 56U);
    EXPECT_EQ(offsetof(eventide_counters, dropped_images), 88U);
}

TEST(CLayout, OfStatusesStays) {
    EXPECT_EQ(int(EVENTIDE_OK), 0);
    EXPECT_EQ(int(EVENTIDE_FAILED), 1);
    EXPECT_EQ(int(EVENTIDE_USAGE), 2);
    EXPECT_EQ(int(EVENTIDE_INPUT), 3);
    EXPECT_EQ(int(EVENTIDE_DEVICE), 4);
    EXPECT_EQ(int(EVENTIDE_NONE), 5);
}

}  // namespace
}  // namespace eventide::test
