// How far an empty window reaches into silence.
#include "src/binning/silence_tracker.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

SensorTime ms(std::int64_t t) {
    return from_us(1000 * t);
}

/// Windows of 1 ms; the first three of a silence come one by one.
SilenceTracker tracker_after(int empty_windows) {
    SilenceTracker silence;
    silence.set_windows(SensorDuration{1000}, 3);
    for (int i = 0; i < empty_windows; ++i) silence.end_window(true);
    return silence;
}

TEST(SilenceTracker, TheFirstEmptyWindowsComeOneByOne) {
    for (const int empty_windows : {0, 2, 3}) {
        SilenceTracker silence = tracker_after(empty_windows);
        silence.see(ms(5));
        silence.see(ms(60));
        EXPECT_EQ(silence.widened(ms(10), ms(1000)) > ms(10), empty_windows == 3) << empty_windows;
    }
}

TEST(SilenceTracker, ASilenceThatIsNotOverIsNotWidened) {
    SilenceTracker silence = tracker_after(3);
    silence.see(ms(5));
    EXPECT_EQ(silence.widened(ms(10), ms(1000)), ms(10));
}

TEST(SilenceTracker, AWindowWithEventsEndsTheSilence) {
    SilenceTracker silence = tracker_after(3);
    silence.see(ms(5));
    silence.see(ms(60));
    silence.end_window(false);
    EXPECT_EQ(silence.empty_windows(), 0);
    EXPECT_EQ(silence.widened(ms(10), ms(1000)), ms(10));
}

TEST(SilenceTracker, ThePauseBetweenTwoTimesLessTheLastWindowsIsOneWindow) {
    SilenceTracker silence = tracker_after(3);
    silence.see(ms(5));
    silence.see(ms(60));
    EXPECT_EQ(silence.widened(ms(10), ms(1000)), ms(57)) << "1 us before 60 less two windows";
    EXPECT_EQ(silence.widened(ms(10), ms(30)), ms(28)) << "no further than is quiet";
    EXPECT_EQ(silence.widened(ms(57), ms(1000)), ms(57)) << "the last ones come one by one again";
}

TEST(SilenceTracker, AShortPauseWidensNothing) {
    SilenceTracker silence = tracker_after(3);
    silence.see(ms(10));
    silence.see(ms(13));
    EXPECT_EQ(silence.widened(ms(10), ms(1000)), ms(10));
}

TEST(SilenceTracker, WhatIsSeenLaterDoesNotChangeAnEarlierPause) {
    SilenceTracker silence = tracker_after(3);
    silence.see(ms(5));
    silence.see(ms(60));
    const SensorTime edge = silence.widened(ms(10), ms(1000));
    silence.see(ms(61));
    silence.see(ms(500));
    EXPECT_EQ(silence.widened(ms(10), ms(1000)), edge);
    EXPECT_EQ(silence.widened(ms(70), ms(1000)), ms(497));
    silence.forget_pauses_until(ms(60));
    EXPECT_EQ(silence.widened(ms(70), ms(1000)), ms(497)) << "a later pause is still known";
}

TEST(SilenceTracker, AStreamThatGoesOnElsewhereIsAsSilentAsItWas) {
    SilenceTracker silence = tracker_after(0);
    silence.restore(99, ms(5));
    EXPECT_EQ(silence.empty_windows(), 3) << "more than needed is not counted";
    silence.see(ms(60));
    EXPECT_EQ(silence.widened(ms(10), ms(1000)), ms(57));
    silence.reset();
    EXPECT_EQ(silence.empty_windows(), 0);
    EXPECT_EQ(silence.newest(), SensorTime::min());
}

}  // namespace
}  // namespace eventide
