// What flickers and what does not.
#include "pipeline/filters/filter_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace eventide {
namespace {

constexpr SensorPixels kSensor{64, 48};

Event at(std::int64_t us, int x, int y, Polarity polarity) {
    return {from_us(us), std::uint16_t(x), std::uint16_t(y), polarity};
}

/// A pixel before a lamp: two on events and an off event in each cycle, each up to `jitter` us
/// late.
std::vector<Event> lamp(int x, double hz, double seconds, int jitter = 0, std::int64_t from = 0) {
    std::mt19937 random(5);
    std::vector<Event> events;
    for (double cycle = 0; cycle < seconds * hz; ++cycle) {
        const auto begin = from + std::int64_t(1e6 * cycle / hz);
        for (const auto& [share, polarity] :
             {std::pair{0., Polarity::on}, {.1, Polarity::on}, {.6, Polarity::off}})
            events.push_back(at(begin + std::int64_t(1e6 * share / hz) +
                                    (jitter > 0 ? std::int64_t(random()) % jitter : 0),
                                x, 7, polarity));
    }
    return events;
}

std::vector<Event> in_order(std::vector<Event> events) {
    std::ranges::stable_sort(events, {}, &Event::t);
    return events;
}

std::vector<Event> left(const std::vector<Event>& events, const std::string& filter = "flicker") {
    FilterChain chain({filter}, kSensor);
    Batch batch;
    batch.events = events;
    chain.process(batch);
    return batch.events;
}

TEST(FlickerFilter, LeavesOutALampFromItsThirdAgreeingCycleOn) {
    for (const double hz : {60., 100., 120., 300.}) {
        const auto events = lamp(3, hz, 2);
        EXPECT_EQ(left(events), std::vector<Event>(events.begin(), events.begin() + 9)) << hz;
        const auto uneven = lamp(3, hz, 2, int(50'000 / hz));
        EXPECT_LT(left(uneven).size(), uneven.size() / 20) << hz << " Hz, 5 % of a cycle late";
    }
}

TEST(FlickerFilter, KeepsWhatFlickersBeyondItsBand) {
    for (const double hz : {5., 30., 700.}) {
        const auto events = lamp(3, hz, 2);
        EXPECT_EQ(left(events), events) << hz;
    }
    const auto lamps = lamp(3, 100, 1), screen = lamp(3, 60, 1);
    EXPECT_LT(left(lamps, "flicker:80..130").size(), 10U);
    EXPECT_EQ(left(screen, "flicker:80..130"), screen);
    EXPECT_LT(left(lamp(3, 20, 2), "flicker:10..50").size(), 10U);
}

TEST(FlickerFilter, ForgivesACycleThatWasTooFaint) {
    auto events = lamp(3, 100, 1);
    const auto is_faint = [](const Event& event) {
        const auto cycle = to_us(event.t) / 10'000;
        return cycle > 4 && cycle % 5 == 0;
    };
    std::erase_if(events, is_faint);
    EXPECT_EQ(left(events).size(), 9U);
}

TEST(FlickerFilter, KeepsNoiseAndEdgesThatPass) {
    std::mt19937 random(7);
    std::vector<Event> noise;
    std::int64_t t = 0;
    for (int i = 0; i < 50'000; ++i)  // 10 Hz for each pixel
        noise.push_back(
            at(t += random() % 65, int(random() % 64), int(random() % 48), Polarity(random() % 2)));
    EXPECT_GT(left(noise).size(), noise.size() * 999 / 1000);

    std::vector<Event> edges;  // bars 8 px apart, each an on and an off event: 25 Hz at 200 px/s
    for (int step = 0; step < 400; ++step)
        for (int x = 0; x < 64; ++x)
            if ((x + 64 - step % 64) % 4 == 0)
                edges.push_back(at(5'000 * step + x, x, 9, Polarity((x + step / 4) % 2 != 0)));
    EXPECT_EQ(left(edges), edges);
}

TEST(FlickerFilter, SeesWhatMovesAcrossALampThatIsOff) {
    auto events = lamp(3, 100, .5);
    const auto passes = [](std::int64_t us) {
        return std::vector<Event>{at(us, 3, 7, Polarity::on), at(us + 1'000, 3, 7, Polarity::off)};
    };
    const auto later = passes(600'000);
    events.insert(events.end(), later.begin(), later.end());
    const auto kept = left(events);
    ASSERT_EQ(kept.size(), 11U);
    EXPECT_TRUE(std::ranges::equal(later, std::vector<Event>(kept.end() - 2, kept.end())));
    // And the lamp that is lit again is learnt again.
    const auto again = lamp(3, 100, .5, 0, 1'000'000);
    events.insert(events.end(), again.begin(), again.end());
    EXPECT_EQ(left(events).size(), 20U);
}

TEST(FlickerFilter, BeginsAnewWhereTheClockGoesBack) {
    auto events = lamp(3, 100, .5, 0, 5'000'000);
    const auto again = lamp(3, 100, .5);
    events.insert(events.end(), again.begin(), again.end());
    EXPECT_EQ(left(events).size(), 18U);
}

TEST(FlickerFilter, PixelsDoNotHangOnEachOther) {
    const auto lamps = lamp(3, 100, 1), other = lamp(4, 30, 1);
    auto events = lamps;
    events.insert(events.end(), other.begin(), other.end());
    EXPECT_EQ(left(in_order(events)).size(), 9 + other.size());
}

}  // namespace
}  // namespace eventide
