// Events that wait for their window, across resets of the camera's clock.
#include "src/binning/pending_events.h"

#include <gtest/gtest.h>

namespace eventide {
namespace {

Event at(std::int64_t t_us) {
    return {from_us(t_us), 1, 2, Polarity::on};
}

std::vector<std::int64_t> times_of(std::span<const Event> events) {
    std::vector<std::int64_t> times;
    for (const Event& event : events) times.push_back(to_us(event.t));
    return times;
}

using Times = std::vector<std::int64_t>;

TEST(PendingEvents, AreTakenUpToATimeInclusive) {
    PendingEvents pending;
    for (const int t : {1, 5, 5, 9}) pending.push(at(t));
    EXPECT_EQ(times_of(pending.take_until(from_us(5))), (Times{1, 5, 5}));
    EXPECT_EQ(times_of(pending.segment()), (Times{9}));
    EXPECT_TRUE(pending.take_until(from_us(8)).empty());
}

TEST(PendingEvents, WhatWasTakenIsThereUntilItIsDropped) {
    PendingEvents pending;
    for (const int t : {1, 2, 3}) pending.push(at(t));
    const auto first = pending.take_until(from_us(1)), second = pending.take_until(from_us(2));
    EXPECT_EQ(times_of(first), (Times{1}));
    EXPECT_EQ(times_of(second), (Times{2}));
    pending.drop_taken();
    EXPECT_EQ(times_of(pending.segment()), (Times{3}));
}

TEST(PendingEvents, AResetOfTheClockBeginsASegment) {
    PendingEvents pending;
    for (const int t : {7, 8}) pending.push(at(t));
    EXPECT_FALSE(pending.segment_has_ended());
    pending.end_segment(from_us(10), from_us(0));
    for (const int t : {1, 2}) pending.push(at(t));
    ASSERT_TRUE(pending.segment_has_ended());
    EXPECT_EQ(pending.segment_final(), from_us(10));
    EXPECT_EQ(times_of(pending.take_until(from_us(7))), (Times{7}));
    pending.drop_taken();
    EXPECT_EQ(times_of(pending.take_until(from_us(99))), (Times{8})) << "none of the next segment";
    EXPECT_EQ(pending.next_segment(), from_us(0));
    EXPECT_FALSE(pending.segment_has_ended());
    EXPECT_EQ(times_of(pending.segment()), (Times{1, 2}));
}

TEST(PendingEvents, AreReplacedByThoseOfAState) {
    PendingEvents pending;
    pending.push(at(7));
    pending.end_segment(from_us(9), from_us(0));
    pending.assign(std::vector{at(3), at(4)});
    EXPECT_FALSE(pending.segment_has_ended());
    EXPECT_EQ(times_of(pending.segment()), (Times{3, 4}));
    pending.clear();
    EXPECT_TRUE(pending.segment().empty());
}

}  // namespace
}  // namespace eventide
