// Windows by content: short where much moves, wherever on the sensor that is.
#include "tests/binning/event_windows.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace eventide {
namespace {

constexpr int kSide = TileActivity::kSide;

/// `per_ms` events a millisecond for `ms`, evenly in time, over the tiles [0, columns) x [0, rows).
std::vector<Event> moving(int columns, int rows, int per_ms, int ms, std::int64_t begin_us = 1) {
    std::mt19937 rng{5};
    std::vector<Event> events;
    for (int i = 0; i < per_ms * ms; ++i)
        events.push_back({from_us(begin_us + std::int64_t(i) * 1000 / per_ms),
                          std::uint16_t(rng() % unsigned(columns * kSide)),
                          std::uint16_t(rng() % unsigned(rows * kSide)), Polarity::on});
    return events;
}

std::int64_t longest(const std::vector<Kept>& event_windows) {
    std::int64_t us = 0;
    for (const Kept& event_window : event_windows)
        us = std::max(us, event_window.end_us - event_window.begin_us);
    return us;
}

TEST(SlicerContent, AStillSceneEndsItsWindowsByTime) {
    const auto event_windows = event_windows_of(by_content(.5), moving(7, 5, 1, 400));
    for (std::size_t i = 0; i + 1 < event_windows.size(); ++i)
        EXPECT_EQ(event_windows[i].end_us - event_windows[i].begin_us, 50'000) << i;
}

TEST(SlicerContent, TwiceTheMotionGivesHalfTheWidth) {
    const auto width = [](int per_ms) {
        const auto event_windows = event_windows_of(by_content(.5), moving(7, 5, per_ms, 200));
        return double(event_windows[0].end_us - event_windows[0].begin_us);
    };
    EXPECT_NEAR(width(4000) / width(2000), .5, .02);
    EXPECT_NEAR(width(4000), .5 * 7 * 5 * kSide * kSide / 4, 400) << "the mean of the tiles is .5";
}

TEST(SlicerContent, ABurstOnAPartOfTheSensorCounts) {
    const auto event_windows = event_windows_of(by_content(.5), moving(2, 2, 200, 200));
    // 4 of 48 tiles, .5 events per pixel in 10 ms: on the whole sensor as many would take 108 ms.
    EXPECT_LT(longest(event_windows), 12'000);
}

TEST(SlicerContent, ASensorOfOneTileIsBusyWhereThatIsFull) {
    Slicer slicer{by_content(.5), kSide, kSide};
    slicer.push(moving(1, 1, 40, 100));
    slicer.finish();
    std::vector<Kept> event_windows;
    take(slicer, event_windows);
    EXPECT_LT(longest(event_windows), 20'000) << ".5 events of each of 1024 pixels in 13 ms";
}

TEST(SlicerContent, ATileThatTheSensorCutsIsFullWithEventsOfItsOwnPixels) {
    // Two tiles, both of which must be full: one of 32 x 20 px, one of 8 x 20.
    Slicer slicer{by_content(.5), 40, 20};
    slicer.push(moving(1, 1, 100, 8));
    std::vector<Event> rim;
    for (int i = 0; i < 80; ++i)
        rim.push_back(
            {from_us(8000 + i), std::uint16_t(32 + i % 8), std::uint16_t(i / 8), Polarity::on});
    slicer.push(rim);
    slicer.advance(from_us(20'000));
    std::vector<Kept> event_windows;
    take(slicer, event_windows);
    ASSERT_EQ(event_windows.size(), 1U);
    EXPECT_EQ(event_windows[0].end_us, 8079) << "with the 80th of 160 pixels";
}

TEST(SlicerContent, OneHotPixelEndsNoWindow) {
    std::vector<Event> events;
    for (std::int64_t us = 1; us <= 200'000; us += 2) events.push_back(at(us, 7));
    for (const Kept& event_window : event_windows_of(by_content(.5), events))
        EXPECT_TRUE(event_window.end_us == events.back().t.time_since_epoch().count() ||
                    event_window.end_us - event_window.begin_us == 50'000);
}

TEST(SlicerContent, ATileFullOfHotPixelsEndsNoWindowOfAnySensor) {
    // Of few tiles: a sixteenth of them is less than two.
    const std::vector<Event> events = moving(1, 1, 2000, 200);
    for (const auto& [width, height] : {std::pair{64, 32}, {128, 96}, {160, 120}}) {
        Slicer slicer(by_content(.4), width, height);
        slicer.push(events);
        std::vector<Kept> event_windows;
        take(slicer, event_windows);
        ASSERT_GE(event_windows.size(), 3U);
        for (const Kept& event_window : event_windows)
            EXPECT_EQ(event_window.end_us - event_window.begin_us, 50'000)
                << width << 'x' << height;
    }
}

/// A contour as high as the sensor that passes a pixel in `us_per_px`, each with `each` events.
std::vector<Event> passing(int each, int us_per_px) {
    std::vector<Event> events;
    for (int x = 0; x < 200; ++x)
        for (int i = 0; i < each; ++i)
            for (int y = 0; y < 180; ++y)
                events.push_back({from_us(1 + x * us_per_px + i * us_per_px / each),
                                  std::uint16_t(x), std::uint16_t(y), Polarity::on});
    return events;
}

TEST(SlicerContent, AContourOfHighContrastMovesAsFarAsAFainterOne) {
    // Two events of each pixel fill a tile after 6.4 of its 32 columns, twenty as well.
    const auto windows = [](int each) {
        return double(event_windows_of(by_content(.4), passing(each, 500)).size());
    };
    EXPECT_NEAR(windows(2), 200 / 6.4, 10);
    EXPECT_NEAR(windows(20), windows(2), 10);
    EXPECT_GT(windows(1), 9) << "12.8 columns and more";
    EXPECT_LT(windows(1), windows(2));
}

TEST(SlicerContent, NoEventEndsAWindowBeforeAMillisecond) {
    const auto event_windows = event_windows_of(by_content(.5), moving(7, 5, 100'000, 20));
    for (std::size_t i = 0; i + 1 < event_windows.size(); ++i)
        EXPECT_EQ(event_windows[i].end_us - event_windows[i].begin_us, 1'000) << i;
}

TEST(SlicerContent, EventsOutsideTheSensorCountNowhere) {
    std::vector<Event> events = moving(2, 1, 2000, 50);
    for (Event& event : events) event.x = std::uint16_t(event.x + 240);
    EXPECT_GE(longest(event_windows_of(by_content(.5), events)), 49'000);
    for (Event& event : events) {
        event.x = std::uint16_t(event.x - 240);
        event.y = std::uint16_t(event.y + 180);
    }
    EXPECT_GE(longest(event_windows_of(by_content(.5), events)), 49'000);
}

}  // namespace
}  // namespace eventide
