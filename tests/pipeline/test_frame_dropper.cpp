// What is rendered when not all can be: the newest always, the rest evenly.
#include "pipeline/pace/frame_dropper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace eventide {
namespace {

using namespace std::chrono_literals;

/// Which of `due` frames are kept, with event windows every 50 ms and frames of `cost`.
std::vector<bool> kept_of(FrameDropper& dropper, std::uint64_t due, HostTime::duration cost,
                          int rounds, std::size_t waiting = 0, std::optional<double> in_time = {}) {
    static HostTime now{};  // goes on over all calls
    std::vector<bool> kept;
    for (int round = 0; round < rounds; ++round) {
        now += 50ms;
        dropper.open({.frames = due, .in_time = in_time}, now);
        kept.assign(due, false);
        for (std::uint64_t i = 0; i < due; ++i) {
            kept[i] = dropper.keeps_next(waiting);
            if (kept[i]) dropper.took(cost);
        }
    }
    return kept;
}

TEST(FrameDropper, KeepsAllWhereThereIsTime) {
    FrameDropper dropper(2);
    for (const bool kept : kept_of(dropper, 10, 1ms, 20)) EXPECT_TRUE(kept);
}

TEST(FrameDropper, KeepsAsManyAsThereIsTimeForEvenlyAndTheNewest) {
    FrameDropper dropper(2);
    const auto kept = kept_of(dropper, 100, 1ms, 50);
    EXPECT_EQ(std::count(kept.begin(), kept.end(), true), 45);
    EXPECT_TRUE(kept.back());
    for (std::size_t i = 0; i + 3 < kept.size(); ++i)
        EXPECT_TRUE(kept[i] || kept[i + 1] || kept[i + 2]) << i;
}

TEST(FrameDropper, KeepsTheNewestHoweverSlowRenderingIs) {
    FrameDropper dropper(2);
    for (const std::size_t waiting : {0U, 1U}) {
        const auto kept = kept_of(dropper, 7, 500ms, 50, waiting);
        EXPECT_EQ(std::count(kept.begin(), kept.end(), true), 1);
        EXPECT_TRUE(kept.back());
    }
}

TEST(FrameDropper, ASlowFrameCountsATenth) {
    FrameDropper dropper(2);
    kept_of(dropper, 10, 1ms, 50);
    dropper.took(200ms);  // 20.9 ms in the mean, 2.15 times in 45 ms
    const auto kept = kept_of(dropper, 10, 1ms, 1);
    EXPECT_EQ(std::count(kept.begin(), kept.end(), true), 2);
}

TEST(FrameDropper, KeepsFramesWhereNoEventWindowMayWait) {
    FrameDropper dropper(0);
    for (const bool kept : kept_of(dropper, 10, 1ms, 20)) EXPECT_TRUE(kept);
}

TEST(FrameDropper, RecoversWhenRenderingIsQuickAgain) {
    FrameDropper dropper(2);
    kept_of(dropper, 10, 500ms, 50);
    for (const bool kept : kept_of(dropper, 10, 1ms, 100)) EXPECT_TRUE(kept);
}

TEST(FrameDropper, LeavesFramesOutWhileEventWindowsPileUp) {
    FrameDropper dropper(2);
    for (const bool kept : kept_of(dropper, 10, 1ms, 5, 2)) EXPECT_FALSE(kept);
    for (const bool kept : kept_of(dropper, 10, 1ms, 5, 1)) EXPECT_TRUE(kept);
}

TEST(FrameDropper, CountsTheFramesOfAHalvedRateByTheirNumbersOnTheClock) {
    // Every fourth number, wherever the window begins.
    const auto kept = [](std::uint64_t first, std::uint64_t frames) {
        FrameDropper dropper(2);
        dropper.open({.first = first, .frames = frames, .halvings = 2, .in_time = 1}, HostTime{});
        std::vector<std::uint64_t> numbers;
        for (std::uint64_t number = first; number < first + frames; ++number)
            if (dropper.keeps_next(0)) numbers.push_back(number);
        return numbers;
    };
    EXPECT_EQ(kept(5, 7), (std::vector<std::uint64_t>{8})) << "all there are";
    EXPECT_EQ(kept(5, 8), (std::vector<std::uint64_t>{12})) << "one of two: the newer";
    EXPECT_TRUE(kept(5, 3).empty());
}

TEST(FrameDropper, OfAWindowThatIsTooLateTheNewestFrameIsKeptWhereNothingNewerIsThere) {
    const auto kept = [](double in_time, std::size_t waiting) {
        FrameDropper dropper(2);
        dropper.open({.frames = 6, .in_time = in_time}, HostTime{});
        std::vector<std::uint64_t> numbers;
        for (std::uint64_t i = 0; i < 6; ++i)
            if (dropper.keeps_next(waiting)) numbers.push_back(i);
        return numbers;
    };
    EXPECT_EQ(kept(2, 1), (std::vector<std::uint64_t>{2, 5}));
    EXPECT_EQ(kept(0, 0), (std::vector<std::uint64_t>{5}));
    EXPECT_TRUE(kept(0, 1).empty()) << "the next window's frames will be newer";
}

TEST(FrameDropper, KeepsNoMoreThanThereIsTimeForWhateverWouldBeInTime) {
    FrameDropper dropper(2);
    kept_of(dropper, 10, 15ms, 50);  // 3 in 45 ms
    const auto kept = kept_of(dropper, 10, 15ms, 1, 0, 5);
    EXPECT_EQ(std::count(kept.begin(), kept.end(), true), 3);
}

}  // namespace
}  // namespace eventide
