// Where times lie among event windows, and which of them can be rendered.
#include "src/model/latent_window.h"

#include <gtest/gtest.h>

#include <initializer_list>
#include <utility>

namespace eventide {
namespace {

using Edges = std::pair<int, int>;  // us

LatentWindow of(std::initializer_list<Edges> windows) {
    LatentWindow window;
    for (const auto& [begin, end] : windows) {
        LatentMap latent;
        latent.window = {from_us(begin), from_us(end)};
        window.push(latent);
    }
    return window;
}

void expect_at(const LatentWindow& window, int us, std::int64_t k, double fraction) {
    const FramePosition found = window.locate(from_us(us));
    EXPECT_EQ(found.k, k) << us << " us";
    EXPECT_DOUBLE_EQ(found.fraction, fraction) << us << " us";
}

TEST(LatentWindow, ATimeLiesInTheWindowThatItEndsOrIsWithin) {
    const LatentWindow window = of({{0, 100}, {100, 300}});
    expect_at(window, -1, 0, 0);
    expect_at(window, 0, 1, 0);  // the stream's first instant
    expect_at(window, 1, 1, .01);
    expect_at(window, 100, 1, 1);
    expect_at(window, 150, 2, .25);
    expect_at(window, 300, 2, 1);
    expect_at(window, 301, 3, 0);
}

TEST(LatentWindow, ATimeBetweenWindowsLiesAtTheLaterOnesBegin) {
    const LatentWindow window = of({{0, 100}, {150, 250}});
    expect_at(window, 100, 1, 1);
    for (const int us : {101, 149, 150}) expect_at(window, us, 2, 0);
    expect_at(window, 175, 2, .25);
}

TEST(LatentWindow, AWindowWithoutWidthIsItsEnd) {
    const LatentWindow window = of({{100, 100}, {100, 200}});
    expect_at(window, 99, 0, 0);
    expect_at(window, 100, 1, 1);
    expect_at(window, 150, 2, .5);
}

TEST(LatentWindow, TimesUpToTheBeginOfTheOldestKeptAreGone) {
    const LatentWindow window =
        of({{0, 100}, {100, 200}, {200, 300}, {310, 400}, {400, 500}, {500, 600}, {600, 700}});
    for (const int us : {0, 150, 200}) expect_at(window, us, 0, 0);
    expect_at(window, 201, 3, .01);
    const LatentWindow next =
        of({{0, 100}, {110, 200}, {200, 300}, {300, 400}, {400, 500}, {500, 600}});
    for (const int us : {105, 110}) expect_at(next, us, 0, 0);
}

TEST(LatentWindow, AFrameIsReadyWhereAllThatItMayReadIsKept) {
    LatentWindow window;
    EXPECT_EQ(window.readiness(from_us(5), 0), Readiness::later);
    window = of({{0, 100}, {100, 200}, {200, 300}, {300, 400}, {400, 500}, {500, 600}});
    const auto readiness = [&](int us, int lookahead) {
        return window.readiness(from_us(us), lookahead);
    };
    EXPECT_EQ(readiness(250, 0), Readiness::gone) << "a fading edge reads the first map";
    EXPECT_EQ(readiness(350, 2), Readiness::ready);
    EXPECT_EQ(readiness(450, 2), Readiness::later);
    EXPECT_EQ(readiness(450, 1), Readiness::ready);
    EXPECT_EQ(readiness(601, 0), Readiness::later);
    window.finish();
    EXPECT_EQ(readiness(450, 2), Readiness::ready);
    EXPECT_EQ(readiness(601, 0), Readiness::gone);
    window.reset();
    EXPECT_EQ(readiness(450, 0), Readiness::later);
}

TEST(LatentWindow, TheOldestTimeIsTheFirstThatIsNotGone) {
    LatentWindow window;
    EXPECT_EQ(window.oldest(), SensorTime::min());
    for (int i = 0; i < 7; ++i) {
        LatentMap latent;
        latent.window = {from_us(100 * i), from_us(100 * i + 100)};
        window.push(latent);
        EXPECT_EQ(window.readiness(window.oldest(), 0), Readiness::ready) << i;
        EXPECT_EQ(window.readiness(window.oldest() - SensorDuration{1}, 0), Readiness::gone) << i;
    }
}

TEST(LatentWindow, OfTheFirstWindowsNoneIsGone) {
    const LatentWindow window = of({{0, 100}, {100, 200}});
    for (const int us : {0, 50, 150, 200})
        EXPECT_EQ(window.readiness(from_us(us), 0), Readiness::ready) << us;
    EXPECT_EQ(window.readiness(from_us(-1), 0), Readiness::gone);
}

}  // namespace
}  // namespace eventide
