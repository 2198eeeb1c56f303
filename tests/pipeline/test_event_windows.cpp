// What closes event windows: events, the stream's clock, the host's clock in silence; gaps.
#include "tests/pipeline/event_windows_by_hand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

namespace eventide {
namespace {

using namespace test;

TEST(EventWindows, OfARecordingAreClosedByEventsNotByItsClock) {
    Beginning b(false);
    b.give(record(ToyKind::event, 1), 0);
    b.give(record(ToyKind::clock, 95), 0);
    b.give({}, 1'000'000);
    EXPECT_TRUE(b.edges.empty());
    b.give(record(ToyKind::event, 12), 0);
    EXPECT_EQ(b.edges, (Edges{{0, 10}}));
    EXPECT_EQ(b.counters.snapshot().slicing.late, 0U);
    b.finish();
    EXPECT_EQ(b.edges.back().second, 95) << "the recording's trailing silence is part of it";
}

TEST(EventWindows, OfALiveSourceAreClosedByItsClockToo) {
    Beginning b(true);
    b.give(record(ToyKind::event, 1), 0);
    b.give(record(ToyKind::clock, 25), 0);
    EXPECT_EQ(b.edges, (Edges{{0, 10}, {10, 20}}));
}

TEST(EventWindows, GoOnByTheHostsClockInSilence) {
    Beginning b(true);
    b.give(record(ToyKind::event, 1), 5000);
    b.give({}, 5100);
    EXPECT_TRUE(b.edges.empty()) << "within the margin the silence may be the cable's";
    b.give({}, 5125);
    EXPECT_EQ(b.edges, (Edges{{0, 10}, {10, 20}}));
    b.give({}, 5145);
    EXPECT_EQ(b.edges.size(), 4U);
    b.give(record(ToyKind::event, 46), 5150);
    b.give(record(ToyKind::event, 61), 5170);
    EXPECT_EQ(b.edges.size(), 6U);
    EXPECT_EQ(b.counters.snapshot().slicing.late, 0U);
}

TEST(EventWindows, DoNotBeginByTheHostsClock) {
    Beginning b(true);
    b.give({}, 5'000'000);
    b.finish();
    EXPECT_TRUE(b.edges.empty());
}

TEST(EventWindows, OfAStreamWithoutEventsAreNone) {
    Beginning b(false);
    b.give(record(ToyKind::clock, 500), 0);
    b.finish();
    EXPECT_TRUE(b.edges.empty());
}

TEST(EventWindows, OfARecordingEndWithItsEventsWhereImagesHaveAnotherClock) {
    constexpr std::int64_t kSince1970 = 1'633'953'690'000'000;
    Beginning b(false);
    b.give(record(ToyKind::event, 1), 0);
    b.give(record(ToyKind::image, kSince1970), 0);
    b.give(record(ToyKind::event, 12), 0);
    b.finish();
    EXPECT_EQ(b.edges, (Edges{{0, 10}, {10, 12}})) << "not in the year of the images";
    EXPECT_EQ(b.counters.snapshot().images_apart, SensorDuration{kSince1970 - 12});
}

TEST(EventWindows, CarryAGapAndTheParserTakesUpAfterIt) {
    Beginning b(true);
    auto half = record(ToyKind::event, 1);
    const auto more = record(ToyKind::event, 2);
    half.insert(half.end(), more.begin(), more.begin() + 5);
    b.give(half, 0);
    b.give(record(ToyKind::event, 35), 0, true);
    EXPECT_EQ(b.edges, (Edges{{0, 10}, {10, 20}, {20, 30}}));
    EXPECT_EQ(b.gaps, (std::vector{true, false, false}));
    EXPECT_EQ(b.counters.snapshot().gaps, 1U);
    EXPECT_EQ(b.counters.snapshot().events, 2U)
        << "half a record is dropped, the next one is whole";
}

TEST(EventWindows, EndedOnPurposeHaveNoTruncatedRecord) {
    const auto truncated_with = [](EventWindows::End end, std::int64_t past_us) {
        EventWindows::Settings settings = Beginning::settings(10);
        settings.slicer.end = from_us(50);
        Counters counters;
        ToySource source({}, false);
        EventWindows frames(source, settings, nullptr, nullptr, counters);
        RawPacket packet;
        packet.bytes = record(ToyKind::event, past_us);
        packet.bytes.push_back(std::byte{1});  // the next record begins
        frames.take(packet);
        frames.finish(end);
        return counters.snapshot().damaged[DamageReason::truncated];
    };
    EXPECT_EQ(truncated_with(EventWindows::End::of_source, 5), 1U);
    EXPECT_EQ(truncated_with(EventWindows::End::asked_for, 5), 0U);
    EXPECT_EQ(truncated_with(EventWindows::End::of_source, 51), 0U) << "--duration was over";
}

TEST(EventWindows, CountWhatTheParserGivesAndWhatIsDamaged) {
    Beginning b(false);
    auto bytes = record(ToyKind::event, 1);
    const auto image = record(ToyKind::image, 3);
    bytes.insert(bytes.end(), image.begin(), image.end());
    bytes.resize(bytes.size() + 3);
    b.give(bytes, 0);
    b.finish();
    const Snapshot s = b.counters.snapshot();
    EXPECT_EQ(s.events, 1U);
    EXPECT_EQ(s.images, 1U);
    EXPECT_EQ(s.damaged[DamageReason::truncated], 1U);
}

struct DropsOff final : EventFilter, DataObserver {
    void process(std::vector<Event>& events) override {
        std::erase_if(events, [](const Event& e) { return e.polarity == Polarity::off; });
    }
    void see(const Batch& batch) override { seen += batch.events.size(); }
    std::size_t seen = 0;
};

TEST(EventWindows, AreOfWhatTheFilterLeavesAndTheObserverSeesAll) {
    DropsOff both;
    Beginning b(false, 10, &both, &both);
    std::vector<std::byte> bytes;
    for (int t = 1; t <= 9; ++t) append_record(bytes, ToyKind::event, t, 0, 0, t % 3 == 0);
    b.give(bytes, 0);
    EXPECT_EQ(both.seen, 9U);
    EXPECT_EQ(b.counters.snapshot().events, 9U);
    EXPECT_EQ(b.counters.snapshot().filtered_events, 6U);
}

TEST(EventWindows, EventsThatAreLeftOutTellTheTimeAllTheSame) {
    struct KeepsTheFirst final : EventFilter {
        void process(std::vector<Event>& events) override {
            std::erase_if(events, [](const Event& e) { return e.t > from_us(1); });
        }
    } filter;
    std::vector<std::byte> bytes;
    for (int t = 1; t <= 99; t += 7) append_record(bytes, ToyKind::event, t);
    Beginning all(false, 10), filtered(false, 10, &filter);
    for (Beginning* b : {&all, &filtered}) {
        b->give(bytes, 0);
        b->finish();
    }
    EXPECT_EQ(filtered.edges, all.edges);
    EXPECT_EQ(all.edges.size(), 10U);
}

/// For 20 us; every third event is left out.
class HoldsBack final : public EventFilter {
public:
    void process(std::vector<Event>& events) override {
        for (const Event& event : events)
            if (++seen_ % 3 != 0) held_.push_back(event);
        const SensorTime now = events.empty() ? SensorTime::min() : events.back().t;
        events.clear();
        if (now != SensorTime::min()) release(now, events);
    }
    void release(SensorTime now, std::vector<Event>& events) override {
        const auto stay = std::ranges::find_if(
            held_, [&](const Event& event) { return event.t >= known_until(now); });
        events.insert(events.end(), held_.begin(), stay);
        held_.erase(held_.begin(), stay);
    }
    void flush(std::vector<Event>& events) override {
        events.insert(events.end(), held_.begin(), held_.end());
        held_.clear();
    }
    SensorTime known_until(SensorTime now) const override { return now - SensorDuration{20}; }
    std::size_t held() const override { return held_.size(); }

private:
    std::vector<Event> held_;
    int seen_ = 0;
};

TEST(EventWindows, EventsThatAreHeldBackAreInTheWindowsOfTheirTime) {
    for (const bool live : {false, true}) {
        HoldsBack filter;
        Beginning b(live, 10, &filter);
        for (int t = 1; t <= 97; t += 3)
            b.give(record(ToyKind::event, t), t);  // 33, of which 22 stay
        EXPECT_EQ(b.edges.size(), 7U) << "events of the last 20 us may come yet";
        EXPECT_EQ(b.events, 16U);
        if (live) {
            b.give(record(ToyKind::clock, 113), 113);
            EXPECT_EQ(b.edges.size(), 9U) << "nor does the clock promise more";
            b.give({}, 300);
            EXPECT_EQ(b.edges.size(), 17U) << "nor the host's";
            EXPECT_EQ(b.events, 22U);
        }
        b.finish();
        EXPECT_EQ(b.events, 22U);
        EXPECT_EQ(b.counters.snapshot().filtered_events, 11U);
        EXPECT_EQ(b.counters.snapshot().slicing.late, 0U);
    }
}

/// Events and images, of which half are late by up to 40 us.
std::vector<std::byte> events_and_late_images(unsigned seed) {
    std::mt19937 random{seed};
    std::vector<std::byte> bytes;
    for (std::int64_t t = 1; t < 400; t += 1 + random() % 6) {
        append_record(bytes, ToyKind::event, t, int(random() % 8));
        if (random() % 8 == 0)
            append_record(bytes, ToyKind::image, t - std::int64_t(random() % 2 * (random() % 40)));
    }
    return bytes;
}

TEST(EventWindows, KnowTheSameImagesHoweverTheStreamIsSplit) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        const std::vector<std::byte> bytes = events_and_late_images(seed);
        HoldsBack holds_back_by_bytes, holds_back;
        for (auto [by_bytes_filter, filter] :
             {std::pair<EventFilter*, EventFilter*>{nullptr, nullptr},
              {&holds_back_by_bytes, &holds_back}}) {
            Beginning by_bytes(false, 10, by_bytes_filter), whole(false, 10, filter);
            for (const std::byte byte : bytes) by_bytes.give({byte}, 0);
            whole.give(bytes, 0);
            by_bytes.finish();
            whole.finish();
            ASSERT_GT(whole.images.back(), 3U);
            EXPECT_EQ(whole.edges, by_bytes.edges);
            EXPECT_EQ(whole.images, by_bytes.images) << seed;
        }
    }
}

/// Whether a packet happens to reach beyond the end must not matter.
TEST(EventWindows, StopAtNoTimeAfterTheirEnd) {
    const ToySource source{{}, false};
    EventWindows::Settings settings = Beginning::settings(10);
    settings.slicer.end = from_us(30);
    Counters counters;
    EventWindows frames{source, settings, nullptr, nullptr, counters};
    std::vector<std::int64_t> stops;
    frames.stop_at({from_us(20), from_us(30), from_us(40)},
                   [&](SensorTime t) { stops.push_back(to_us(t)); });
    RawPacket packet;
    for (const std::int64_t us : {5, 25, 35, 45}) append_record(packet.bytes, ToyKind::event, us);
    frames.take(packet);
    EXPECT_EQ(stops, (std::vector<std::int64_t>{20, 30}));
}

TEST(EventWindows, SayWhatTheFilterFoundOfFlickeringLight) {
    struct Finds final : EventFilter {
        void process(std::vector<Event>&) override { found = {100.25, 100.25, found.left_out + 2}; }
        void flush(std::vector<Event>&) override { found = {0, 99.5, 7}; }
        FlickerFound flicker() const override { return found; }
        FlickerFound found;
    } filter;
    Beginning b(false, 10, &filter);
    EXPECT_EQ(b.counters.snapshot().flicker.hz, 0);
    b.give(record(ToyKind::event, 1), 0);
    EXPECT_EQ(b.counters.snapshot().flicker.hz, 100.25);
    EXPECT_EQ(b.counters.snapshot().flicker.left_out, 2U);
    b.finish();
    EXPECT_EQ(b.counters.snapshot().flicker.hz, 0);
    EXPECT_EQ(b.counters.snapshot().flicker.last_hz, 99.5);
    EXPECT_EQ(b.counters.snapshot().flicker.left_out, 7U);
}

}  // namespace
}  // namespace eventide
