// How events are cut, changed while they come.
#include "src/core/error.h"
#include "tests/binning/event_windows.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

/// An event each 10 us, from `first_us` to before `end_us`.
std::vector<Event> steady(std::int64_t first_us, std::int64_t end_us) {
    std::vector<Event> events;
    for (std::int64_t us = first_us; us < end_us; us += 10)
        events.push_back(at(us, int(us / 10 % 240)));
    return events;
}

/// Cut by `before` until an event at 2501 us is known, then by `after`.
Edges edges_of_change(const SlicerSettings& before, const SlicerSettings& after) {
    Slicer slicer(before, 240, 180);
    std::vector<Kept> kept;
    slicer.push(steady(1, 2510));
    take(slicer, kept);
    slicer.change(after);
    take(slicer, kept);
    slicer.push(steady(2511, 5000));
    take(slicer, kept);
    std::size_t events = 0;
    for (const Kept& window : kept) events += window.events.size();
    slicer.finish();
    std::vector<Kept> rest;
    take(slicer, rest);
    for (const Kept& window : rest) events += window.events.size();
    EXPECT_EQ(events + slicer.counters().before_begin + slicer.counters().after_end,
              steady(1, 5000).size())
        << "none is lost";
    return edges_of(kept);
}

TEST(SlicerChange, NarrowerWindowsBeginWithTheOpenOne) {
    EXPECT_EQ(edges_of_change(by_duration(1000), by_duration(400)), (Edges{{0, 1000},
                                                                           {1000, 2000},
                                                                           {2000, 2400},
                                                                           {2400, 2800},
                                                                           {2800, 3200},
                                                                           {3200, 3600},
                                                                           {3600, 4000},
                                                                           {4000, 4400},
                                                                           {4400, 4800}}));
}

TEST(SlicerChange, WiderWindowsBeginWithTheOpenOne) {
    EXPECT_EQ(edges_of_change(by_duration(1000), by_duration(1500)),
              (Edges{{0, 1000}, {1000, 2000}, {2000, 3500}}));
}

TEST(SlicerChange, TheRuleMayBeAnother) {
    EXPECT_EQ(edges_of_change(by_duration(2000), by_count(100)),
              (Edges{{0, 2000}, {2000, 2991}, {2991, 3991}}));
    // A tile fills after some of its events; what had come of the open window counts.
    const Edges content = edges_of_change(by_duration(2000), by_content(1e-6));
    EXPECT_EQ(content[1], (std::pair<std::int64_t, std::int64_t>{2000, 3000})) << "the least width";
}

TEST(SlicerChange, SoMayBeTheLeastWidthOfWindowsByContent) {
    SlicerSettings quick = by_content(1e-6), slow = by_content(1e-6);
    quick.min_width = SensorDuration{800};
    slow.min_width = SensorDuration{1300};
    EXPECT_EQ(edges_of_change(quick, slow),
              (Edges{{0, 800}, {800, 1600}, {1600, 2400}, {2400, 3700}}));
    EXPECT_EQ(edges_of_change(slow, quick),
              (Edges{{0, 1300}, {1300, 2100}, {2100, 2900}, {2900, 3700}, {3700, 4500}}));
}

TEST(SlicerChange, WhereAndHowLongIsAsItWas) {
    SlicerSettings settings = by_duration(1000);
    settings.begin = from_us(500);
    settings.end = from_us(3000);
    EXPECT_EQ(edges_of_change(settings, by_duration(300)),
              (Edges{{500, 1500}, {1500, 2500}, {2500, 2800}, {2800, 3000}}));
}

TEST(SlicerChange, WhatIsOutOfRangeChangesNothing) {
    Slicer slicer(by_duration(1000), 240, 180);
    EXPECT_THROW(slicer.change(by_duration(0)), Error);
    EXPECT_THROW(slicer.change(by_count(0)), Error);
    slicer.push(steady(1, 2510));
    std::vector<Kept> kept;
    take(slicer, kept);
    EXPECT_EQ(edges_of(kept), (Edges{{0, 1000}, {1000, 2000}}));
}

TEST(SlicerChange, BeforeAnyEventIsAsFromTheBeginning) {
    Slicer slicer(by_duration(1000), 240, 180);
    slicer.change(by_duration(800));
    slicer.push(steady(1, 2000));
    std::vector<Kept> kept;
    take(slicer, kept);
    EXPECT_EQ(edges_of(kept), (Edges{{0, 800}, {800, 1600}}));
}

}  // namespace
}  // namespace eventide
