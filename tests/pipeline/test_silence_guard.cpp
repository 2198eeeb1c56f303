// How long a stream may be silent, and in what words more is refused.
#include "pipeline/silence_guard.h"

#include "src/core/error.h"

#include <gmock/gmock.h>

#include <string>

namespace eventide {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kMost = SilenceGuard::kMost;

TEST(SilenceGuard, AMillionSilentFramesMayComeAndNotOneMore) {
    SilenceGuard guard;
    EXPECT_FALSE(guard.is_exceeded());
    guard.open(0, kMost - 1);
    guard.open(0, 1);
    EXPECT_FALSE(guard.is_exceeded());
    guard.open(0, 1);
    EXPECT_TRUE(guard.is_exceeded());
}

TEST(SilenceGuard, FramesOfAWindowWithEventsAreNoneHoweverMany) {
    SilenceGuard guard;
    guard.open(0, kMost);
    guard.open(1, 5 * kMost);
    EXPECT_FALSE(guard.is_exceeded());
    guard.open(0, kMost);
    EXPECT_FALSE(guard.is_exceeded()) << "and the silence before them is over";
}

TEST(SilenceGuard, WhatItRefusesItNamesAndCountsAnew) {
    SilenceGuard guard;
    guard.open(0, kMost + 7);
    Window window;
    window.begin = from_us(0);
    window.end = from_us(std::int64_t{36} * 3'600 * 100'000);  // 3.6 hours
    try {
        guard.refuse(window);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), HasSubstr("no events from 0 to 12960000000 us (3.6 hours)"));
        EXPECT_THAT(error.what(), HasSubstr("at most 1000000 frames"));
        EXPECT_THAT(error.what(), HasSubstr("found 1000007"));
        EXPECT_THAT(error.what(), HasSubstr("--allow-silence"));
    }
    EXPECT_FALSE(guard.is_exceeded());
}

}  // namespace
}  // namespace eventide
