// Hot pixels are found and left out; moving edges are not taken for them.
#include "pipeline/filters/hot_pixels.h"
#include "src/core/error.h"
#include "tests/system/process.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace eventide {
namespace {

Event at(std::int64_t t_us, int x, int y) {
    return {from_us(t_us), std::uint16_t(x), std::uint16_t(y), Polarity::on};
}

/// A pixel firing at 1 kHz, and an edge that sweeps over all pixels every 50 ms.
std::vector<Event> hot_pixel_and_edge(int seconds) {
    std::vector<Event> events;
    for (std::int64_t t = 0; t < seconds * 1'000'000LL; t += 1000) {
        events.push_back(at(t, 7, 9));
        const int column = int(t / 1000 % 50);
        if (column < 32)
            for (int y = 0; y < 24; ++y) events.push_back(at(t + 1, column, y));
    }
    return events;
}

std::size_t count_of(const std::vector<Event>& events, int x, int y, std::int64_t from_t) {
    return std::size_t(std::ranges::count_if(events, [&](const Event& event) {
        return event.x == x && event.y == y && to_us(event.t) >= from_t;
    }));
}

TEST(HotPixelFilter, LeavesOutThePixelThatStandsAloneAndKeepsTheEdge) {
    HotPixelFilter filter{32, 24};
    const auto all = hot_pixel_and_edge(1);
    auto events = all;
    filter.process(events);
    EXPECT_EQ(filter.hot_pixels(), 1U);
    EXPECT_EQ(count_of(events, 7, 9, 260'000), 0U);
    EXPECT_EQ(count_of(events, 8, 9, 0), count_of(all, 8, 9, 0));
}

TEST(HotPixelFilter, DoesNotCareHowTheEventsAreSplit) {
    HotPixelFilter whole{32, 24}, parts{32, 24};
    const auto all = hot_pixel_and_edge(1);
    auto expected = all;
    whole.process(expected);
    std::vector<Event> found;
    for (std::size_t i = 0; i < all.size(); i += 613) {
        std::vector<Event> part(all.begin() + std::ptrdiff_t(i),
                                all.begin() + std::ptrdiff_t(std::min(i + 613, all.size())));
        parts.process(part);
        found.insert(found.end(), part.begin(), part.end());
    }
    EXPECT_EQ(found, expected);
}

TEST(HotPixelFilter, TakesAPixelBackWhenItHasCalmedDown) {
    HotPixelFilter filter{32, 24};
    auto events = hot_pixel_and_edge(1);
    filter.process(events);
    std::vector<Event> later{at(5'000'000, 7, 9)};
    filter.process(later);
    EXPECT_EQ(later.size(), 1U);
    EXPECT_EQ(filter.hot_pixels(), 0U);
}

TEST(HotPixelFilter, GoesOnAfterTheClockWasReset) {
    HotPixelFilter filter{32, 24};
    auto events = hot_pixel_and_edge(1);
    for (Event& event : events) event.t += SensorDuration{100'000'000};
    filter.process(events);
    auto again = hot_pixel_and_edge(1);
    filter.process(again);
    EXPECT_EQ(count_of(again, 7, 9, 500'000), 0U);
}

TEST(HotPixelFilter, QuotesALineThatIsNoPixelAsItStands) {
    const test::TempFolder temp;
    test::write_text(temp / "notes.txt", "3,4\nHello, this  is text # said\n");
    try {
        HotPixelFilter filter{32, 24, temp / "notes.txt"};
        FAIL() << "taken for a list";
    } catch (const Error& error) {
        EXPECT_NE(std::string{error.what()}.find(
                      ":2: expected \"x,y\" inside 32x24, found 'Hello, this  is text # said'"),
                  std::string::npos)
            << error.what();
    }
}

TEST(HotPixelFilter, OfAFileThatIsNoTextTheBeginIsQuoted) {
    const test::TempFolder temp;
    test::write_text(temp / "hot.npy", std::string(1'000'000, '\x91'));
    try {
        HotPixelFilter filter{32, 24, temp / "hot.npy"};
        FAIL() << "taken for a list";
    } catch (const Error& error) {
        EXPECT_LT(std::string{error.what()}.size(), 500U);
    }
}

TEST(HotPixelFilter, ReadsAList) {
    const test::TempFolder temp;
    test::write_text(temp / "hot.txt", "# found in the dark\n7,9\n\n3 4  # two\n");
    HotPixelFilter filter{32, 24, temp / "hot.txt"};
    EXPECT_EQ(filter.hot_pixels(), 2U);
    std::vector<Event> events{at(0, 7, 9), at(1, 1, 1), at(2, 3, 4)};
    filter.process(events);
    EXPECT_EQ(events, (std::vector<Event>{at(1, 1, 1)}));
}

TEST(HotPixelFilter, NamesTheLineOfAListThatIsWrong) {
    const test::TempFolder temp;
    for (const char* wrong : {"1,2\n32,1\n", "1,2\n5\n", "1,2\n1,2,3\n", "1,2\nx,y\n"}) {
        test::write_text(temp / "hot.txt", wrong);
        try {
            HotPixelFilter filter{32, 24, temp / "hot.txt"};
            ADD_FAILURE() << wrong;
        } catch (const Error& error) {
            EXPECT_NE(std::string{error.what()}.find("hot.txt:2"), std::string::npos);
        }
    }
    EXPECT_THROW(HotPixelFilter(32, 24, temp / "none.txt"), Error);
}

TEST(HotPixelFilter, ShowsAPieceOfAFileThatIsNoList) {
    const test::TempFolder temp;
    test::write_text(temp / "hot.txt", std::string(100'000, 'x'));
    try {
        HotPixelFilter filter{32, 24, temp / "hot.txt"};
        ADD_FAILURE() << "taken for a list";
    } catch (const Error& error) {
        EXPECT_LT(std::string_view{error.what()}.size(), 1000U);
    }
}

}  // namespace
}  // namespace eventide
