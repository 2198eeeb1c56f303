// What is left out to keep the latency: frames before windows, windows before packets.
#include "pipeline/pace/latency_keeper.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

using namespace std::chrono_literals;

TEST(LatencyKeeper, HalvesTheRateBeforeItMergesAndRestoresItWhenItIsCalm) {
    LatencyKeeper keeper{200ms};
    for (int i = 0; i < 8; ++i) keeper.window_took(35ms);
    keeper.frame_took(20ms);
    EXPECT_TRUE(keeper.hands_on(1));
    keeper.adapt(1);
    EXPECT_EQ(keeper.halvings(), 0U) << "90 ms of 200";
    keeper.window_took(135ms);  // the mean goes to 55 ms
    keeper.adapt(1);
    EXPECT_EQ(keeper.halvings(), 1U) << "130 ms are more than half";
    EXPECT_TRUE(keeper.hands_on(1));
    EXPECT_FALSE(keeper.hands_on(2)) << "185 ms leave too little for packets";
    for (int i = 0; i < 20; ++i) keeper.adapt(0);
    EXPECT_EQ(keeper.halvings(), 0U);
}

TEST(LatencyKeeper, WithoutABoundTheRateStaysHoweverManyWindowsWait) {
    LatencyKeeper keeper{{}};
    keeper.window_took(60ms);
    keeper.adapt(100);
    EXPECT_EQ(keeper.halvings(), 0U);
}

TEST(LatencyKeeper, TwentyWindowsInARowMustBeCalmBeforeTheRateGoesUp) {
    LatencyKeeper keeper{200ms};
    for (int i = 0; i < 8; ++i) keeper.window_took(60ms);
    const auto strain = [&] { keeper.adapt(1); };
    const auto calm = [&](int windows) {
        for (int i = 0; i < windows; ++i) keeper.adapt(0);
        return keeper.halvings();
    };
    for (int i = 0; i < 5; ++i) strain();
    EXPECT_EQ(keeper.halvings(), 2U) << "and no further";
    EXPECT_EQ(calm(19), 2U);
    strain();
    EXPECT_EQ(calm(19), 2U) << "they count anew";
    EXPECT_EQ(calm(1), 1U);
    EXPECT_EQ(calm(19), 1U) << "one halving at a time";
    EXPECT_EQ(calm(1), 0U);
}

TEST(LatencyKeeper, OneLongPauseMakesItLeaveNothingOut) {
    LatencyKeeper keeper{200ms};
    keeper.packet_took(300ms);  // the first, all memory is cold
    for (int i = 0; i < 8; ++i) keeper.packet_took(100us);
    EXPECT_TRUE(keeper.takes_packet(64));
    keeper.packet_took(1s);
    EXPECT_TRUE(keeper.takes_packet(64)) << "the backlog is soon parsed";
    for (int i = 0; i < 20; ++i) keeper.packet_took(10ms);
    EXPECT_FALSE(keeper.takes_packet(64)) << "it has become slow for good";
}

TEST(LatencyKeeper, LearnsFromTheQuickestOfTheFirst) {
    LatencyKeeper keeper{200ms};
    keeper.packet_took(1ms);
    for (int i = 0; i < 7; ++i) keeper.packet_took(30ms);  // memory of its own is cold
    EXPECT_TRUE(keeper.takes_packet(50));
    EXPECT_FALSE(keeper.takes_packet(51));
    keeper.packet_took(30ms);  // the ninth counts a fifth, of 4 ms at most: 1.6 ms
    EXPECT_TRUE(keeper.takes_packet(31));
    EXPECT_FALSE(keeper.takes_packet(32));
}

TEST(LatencyKeeper, AnIdleEncoderTakesAWindowHoweverLongItWillBusyIt) {
    LatencyKeeper keeper{200ms};
    for (int i = 0; i < 8; ++i) keeper.window_took(400ms);
    EXPECT_TRUE(keeper.hands_on(0)) << "waiting would make it no sooner";
    EXPECT_FALSE(keeper.hands_on(1));
    keeper.adapt(0);
    EXPECT_EQ(keeper.halvings(), 0U) << "nor would fewer frames";
}

TEST(LatencyKeeper, AWindowHasThreeQuartersOfTheBoundForThoseBeforeItItselfAndItsFrame) {
    for (const auto frame : {45ms, 55ms}) {
        LatencyKeeper keeper{200ms};
        keeper.window_took(50ms);
        keeper.frame_took(frame);
        EXPECT_EQ(keeper.hands_on(1), frame == 45ms);
    }
}

TEST(LatencyKeeper, NoFrameOfAWindowOlderThanTheBoundIsInTime) {
    LatencyKeeper keeper{200ms};
    EXPECT_FALSE(keeper.frames_in_time(0ms)) << "nothing is known";
    keeper.frame_took(20ms);
    EXPECT_NEAR(keeper.frames_in_time(100ms).value(), 5, 1e-9);
    EXPECT_EQ(keeper.frames_in_time(1s), 0);
    EXPECT_FALSE((LatencyKeeper{{}}.frames_in_time(0ms)));
}

TEST(LatencyKeeper, TakesPacketsWhileTheyCanBeParsedInTime) {
    LatencyKeeper keeper{200ms};
    EXPECT_TRUE(keeper.takes_packet(64)) << "nothing is known";
    keeper.packet_took(5ms);
    EXPECT_TRUE(keeper.takes_packet(10));
    EXPECT_FALSE(keeper.takes_packet(11));
    EXPECT_TRUE((LatencyKeeper{{}}.takes_packet(1000)));
}

}  // namespace
}  // namespace eventide
