// What a run writes of the data it reconstructs from.
#include "apps/cli/run/events_out.h"

#include "src/core/error.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

namespace eventide::app {
namespace {

/// Keeps what it is given, each call apart.
struct KeptBatches final : ConvertTarget {
    explicit KeptBatches(std::vector<Batch>& all) : batches(all) {}
    const FormatHolds& holds() const override {
        static const FormatHolds kAll{
            .events = true, .images = true, .triggers = true, .clock_resets = true};
        return kAll;
    }
    void write(const Batch& batch) override { batches.push_back(batch); }
    void finish() override {}
    std::uint64_t bytes_written() const override { return 0; }
    std::vector<Batch>& batches;
};

Batch image_at(std::int64_t us) {
    Batch batch;
    batch.images.push_back({});
    batch.images.back().t = from_us(us);
    return batch;
}

EventsOut::Limit at(std::optional<SensorTime> t) {
    return [t] { return t; };
}

TEST(EventsOut, TheFileIsBehindAFormatAloneAndMayHaveAColon) {
    for (const auto& [to, file] : {std::pair{"aedat4:x", "x"},
                                   {"text:-", "-"},
                                   {"x.txt", "x.txt"},
                                   {"./text:x.txt", "./text:x.txt"},
                                   {"part.2:x.txt", "part.2:x.txt"},
                                   {"udp://a:1", "udp://a:1"}})
        EXPECT_EQ(file_of_event_target(to), file) << to;
    EXPECT_THROW(file_of_event_target("evt2:x"), Error) << "is only read";
}

TEST(EventsOut, ImagesDoNotWaitForEvents) {
    std::vector<Batch> written;
    EventsOut out{nullptr, std::make_unique<KeptBatches>(written), at({}), at({})};
    for (int n = 0; n < 3; ++n) {
        out.see(image_at(n));
        EXPECT_EQ(written.size(), std::size_t(n + 1)) << "nothing is kept";
    }
    Batch both = image_at(7);
    both.events.push_back({from_us(8), 1, 1, Polarity::on});
    out.see(both);
    out.process(both.events);
    ASSERT_EQ(written.size(), 4U);
    EXPECT_EQ(written.back().images.size(), 1U);
    EXPECT_EQ(written.back().events.size(), 1U) << "together, as they came";
}

/// As they come in one packet, and in two of which the first ends with the reset.
TEST(EventsOut, AResetDividesTheEventsOfTwoClocksWhereverThePacketsEnd) {
    const std::vector<Event> old_clock{{from_us(5'000), 1, 1, Polarity::on},
                                       {from_us(6'000), 1, 1, Polarity::on}},
        new_clock{{from_us(10), 1, 1, Polarity::on}};
    const Trigger reset{from_us(0), Trigger::Kind::timestamp_reset, 0};
    for (const bool at_once : {true, false}) {
        std::vector<Batch> written;
        std::optional<SensorTime> from = from_us(5'500);
        EventsOut out{nullptr, std::make_unique<KeptBatches>(written), [&] { return from; },
                      at({})};
        const auto take = [&](std::vector<Event> events) { out.process(events); };
        Batch batch;
        batch.events = old_clock;
        if (at_once) {
            batch.events.insert(batch.events.end(), new_clock.begin(), new_clock.end());
            batch.triggers = {reset};
        }
        out.see(batch);
        take(old_clock);
        if (!at_once) {
            batch.events.clear();
            batch.triggers = {reset};
            out.see(batch);
        }
        from.reset();  // a time of the old clock
        if (!at_once) {
            batch.events = new_clock;
            batch.triggers.clear();
            out.see(batch);
        }
        take(new_clock);
        ASSERT_GE(written.size(), 2U);
        EXPECT_EQ(written.front().events, std::vector<Event>{old_clock.back()});
        EXPECT_TRUE(written.front().triggers.empty());
        EXPECT_EQ(written[1].triggers, std::vector<Trigger>{reset}) << at_once;
        EXPECT_EQ(written.back().events, new_clock);
    }
}

/// Holds every event back until it is flushed.
class HoldsAll final : public EventFilter {
public:
    void process(std::vector<Event>& events) override {
        held_.insert(held_.end(), events.begin(), events.end());
        events.clear();
    }
    void flush(std::vector<Event>& events) override { events.swap(held_); }
    SensorTime known_until(SensorTime now) const override {
        return held_.empty() ? now : held_.front().t - SensorDuration{1};
    }
    std::size_t held() const override { return held_.size(); }

private:
    std::vector<Event> held_;
};

void see_event(EventsOut& out, std::int64_t us) {
    std::vector<Event> events{{from_us(us), 1, 1, Polarity::on}};
    out.process(events);
}

TEST(EventsOut, ImagesWaitForEventsThatAFilterHolds) {
    for (const bool flushed : {true, false}) {
        HoldsAll filter;
        std::vector<Batch> written;
        EventsOut out{&filter, std::make_unique<KeptBatches>(written), at({}), at({})};
        see_event(out, 10);
        out.see(image_at(9));
        ASSERT_EQ(written.size(), 1U) << "before what is held";
        out.see(image_at(11));
        EXPECT_EQ(written.size(), 1U);
        std::vector<Event> none;
        if (flushed) out.flush(none);
        out.finish();
        ASSERT_EQ(written.size(), 2U) << "of a run that failed, too";
        EXPECT_EQ(written[1].events.size(), 1U);
        EXPECT_EQ(written[1].images.size(), 1U);
    }
}

TEST(EventsOut, WhatLiesOutsideOfThePartIsNotWritten) {
    std::vector<Batch> written;
    EventsOut out{nullptr, std::make_unique<KeptBatches>(written), at(from_us(10)),
                  at(from_us(20))};
    for (const std::int64_t us : {9, 10, 20, 21}) {
        out.see(image_at(us));
        see_event(out, us);
    }
    out.finish();
    std::vector<std::int64_t> events, images;
    for (const Batch& batch : written) {
        for (const Event& event : batch.events) events.push_back(to_us(event.t));
        for (const ReferenceImage& image : batch.images) images.push_back(to_us(image.t));
    }
    EXPECT_EQ(events, (std::vector<std::int64_t>{10, 20}));
    EXPECT_EQ(images, (std::vector<std::int64_t>{10, 20}));
}

}  // namespace
}  // namespace eventide::app
