// What closes event windows: events, the stream's clock, the host's clock in silence; gaps.
#include "pipeline/event_windows.h"
#include "src/codec/prophesee/evt3.h"
#include "src/core/byte_order.h"
#include "tests/support/toy_stages.h"

#include <gtest/gtest.h>

#include <vector>

namespace eventide {
namespace {

using namespace std::chrono_literals;
using namespace test;

using Edges = std::vector<std::pair<std::int64_t, std::int64_t>>;

/// A line's beginning over a toy source, fed by hand.
struct Beginning {
    explicit Beginning(bool live, std::int64_t width_us = 10, EventFilter* filter = nullptr,
                       DataObserver* observer = nullptr)
        : source({}, live), frames(source, settings(width_us), filter, observer, counters) {}

    static EventWindows::Settings settings(std::int64_t width_us) {
        EventWindows::Settings s;
        s.slicer.width = SensorDuration{width_us};
        s.silence_margin = SensorDuration{100};
        return s;
    }
    void give(const std::vector<std::byte>& bytes, std::int64_t host_us, bool gap = false) {
        RawPacket packet;
        packet.bytes = bytes;
        packet.arrived = HostTime{std::chrono::microseconds{host_us}};
        packet.gap_before = gap;
        frames.take(packet);
        take();
    }
    void finish(EventWindows::End end = EventWindows::End::of_source) {
        frames.finish(end);
        take();
    }
    void take() {
        for (EventWindow event_window; frames.next(event_window);) {
            edges.emplace_back(to_us(event_window.window.begin), to_us(event_window.window.end));
            gaps.push_back(event_window.gap_before);
        }
    }

    Counters counters;
    ToySource source;
    EventWindows frames;
    Edges edges;
    std::vector<bool> gaps;
};

std::vector<std::byte> record(ToyKind kind, std::int64_t t_us) {
    std::vector<std::byte> bytes;
    append_record(bytes, kind, t_us);
    return bytes;
}

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

TEST(EventWindows, GoOnWithASourceThatStoodStill) {
    constexpr std::int64_t kMs = 1000;
    Beginning b(true, 10 * kMs);
    b.give(record(ToyKind::event, kMs), 0);
    for (std::int64_t host = 0; host <= 20'000 * kMs; host += 20 * kMs) b.give({}, host);
    const std::size_t of_silence = b.edges.size();
    EXPECT_GT(of_silence, 900U);
    std::int64_t host = 20'000 * kMs, t = kMs;
    const auto send = [&](std::int64_t ms) {
        for (const std::int64_t end = t + ms * kMs; t < end; t += 5 * kMs, host += 5 * kMs)
            b.give(record(ToyKind::event, t), host);
    };
    send(1000);
    EXPECT_EQ(b.edges.size(), of_silence) << "it may have been on its way for long";
    send(1000);
    EXPECT_EQ(b.counters.snapshot().slicing.time_resets, 1U);
    EXPECT_EQ(b.edges.back().second / kMs, 1990);
    EXPECT_GT(b.edges.size(), of_silence + 90);
}

/// Packets are a clock, which may go back, and the time of an event, where it is not below 0.
class OwnClockParser final : public Parser {
public:
    void parse(std::span<const std::byte> bytes, Batch& into) override {
        clock_ = from_us(load_little<std::int64_t>(bytes.data()));
        const auto t = load_little<std::int64_t>(bytes.data() + 8);
        if (t >= 0) into.events.push_back({from_us(t), 1, 1, Polarity::on});
    }
    void finish(Batch&) override {}
    void resync() override {}
    std::optional<SensorTime> clock() const override { return clock_; }
    const Damage& damaged() const override { return damage_; }

private:
    std::optional<SensorTime> clock_;
    Damage damage_;
};

struct OwnClockSource final : Source {
    OwnClockSource() {
        info_.width = kToyWidth;
        info_.height = kToyHeight;
    }
    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return true; }
    ReadStatus read(RawPacket&) override { return ReadStatus::end; }
    void stop() noexcept override {}
    std::unique_ptr<Parser> make_parser() const override {
        return std::make_unique<OwnClockParser>();
    }

private:
    SensorInfo info_;
};

TEST(EventWindows, GoOnWithASourceWhoseOwnClockPromisedTooMuch) {
    constexpr std::int64_t kMs = 1000;
    const OwnClockSource source;
    Counters counters;
    EventWindows windows(source, Beginning::settings(10 * kMs), nullptr, nullptr, counters);
    std::size_t cut = 0;
    const auto give = [&](std::int64_t clock_us, std::int64_t event_us, std::int64_t host_us) {
        RawPacket packet;
        append_little(packet.bytes, std::uint64_t(clock_us));
        append_little(packet.bytes, std::uint64_t(event_us));
        packet.arrived = HostTime{std::chrono::microseconds{host_us}};
        windows.take(packet);
        for (EventWindow window; windows.next(window);) ++cut;
    };
    give(kMs, kMs, 0);
    for (std::int64_t t = 20 * kMs; t <= 20'000 * kMs; t += 20 * kMs) give(t, -1, t);  // paused
    const std::size_t of_silence = cut;
    for (std::int64_t t = 0; t < 2'000 * kMs; t += 5 * kMs)
        give(2 * kMs + t, 2 * kMs + t, 20'000 * kMs + t);
    EXPECT_EQ(counters.snapshot().slicing.time_resets, 1U);
    EXPECT_GT(cut, of_silence + 90);
}

TEST(EventWindows, OfACameraThatBeginsAnewInSilenceDoSoOnce) {
    constexpr std::int64_t kMs = 1000;
    Beginning b(true, 10 * kMs);
    b.give(record(ToyKind::event, 500 * kMs), 0);
    for (std::int64_t host = 0; host <= 20'000 * kMs; host += 20 * kMs) b.give({}, host);
    for (std::int64_t t = kMs; t < 3'000 * kMs; t += 5 * kMs)
        b.give(record(ToyKind::event, t), 20'000 * kMs + t);
    EXPECT_EQ(b.counters.snapshot().slicing.time_resets, 1U);
}

TEST(EventWindows, WaitForWhatWasOnItsWayForLong) {
    constexpr std::int64_t kMs = 1000;
    Beginning b(true, 10 * kMs);
    b.give(record(ToyKind::event, kMs), 0);
    for (std::int64_t host = 0; host <= 5'000 * kMs; host += 20 * kMs) b.give({}, host);
    for (std::int64_t t = kMs; t < 7'000 * kMs; t += 5 * kMs)
        b.give(record(ToyKind::event, t), std::max(t, 5'000 * kMs));
    EXPECT_EQ(b.counters.snapshot().slicing.time_resets, 0U);
    EXPECT_EQ(b.edges.back().second / kMs, 6990);
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

/// A sensor behind V4L2: times of 24 bits.
struct Evt3Source final : Source {
    Evt3Source() {
        info_.width = kToyWidth;
        info_.height = kToyHeight;
    }
    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return true; }
    ReadStatus read(RawPacket&) override { return ReadStatus::end; }
    void stop() noexcept override {}
    std::unique_ptr<Parser> make_parser() const override {
        return std::make_unique<Evt3Parser>(info_.width, info_.height);
    }

private:
    SensorInfo info_;
};

/// An event in each packet.
RawPacket evt3_packet(std::int64_t t_us, HostTime arrived) {
    RawPacket packet;
    packet.arrived = arrived;
    for (const std::int64_t word : {0x8000 | (t_us >> 12 & 0xFFF), 0x6000 | (t_us & 0xFFF),
                                    std::int64_t{1}, std::int64_t{0x2801}})
        append_little(packet.bytes, std::uint16_t(word));
    return packet;
}

TEST(EventWindows, GoOnAtOnceWhereACameraThatCountsAnewWasOpenedAgain) {
    for (const auto seen : {5s, 12s}) {  // before; 24 bits wrap after 16.8 s
        const Evt3Source source;
        Counters counters;
        EventWindows windows(source, {}, nullptr, nullptr, counters);
        HostTime host{1s};
        SensorTime end{};
        int resets = 0;
        const auto take = [&](const RawPacket& packet) {
            windows.take(packet);
            for (EventWindow window; windows.next(window);) {
                EXPECT_GT(window.window.end, end);
                end = window.window.end;
                resets += window.reset_before ? 1 : 0;
            }
        };
        const auto send = [&](SensorDuration for_so_long, bool reopened) {
            for (SensorDuration t{0}; t < for_so_long; t += 5ms, host += 5ms) {
                RawPacket packet = evt3_packet(t.count(), host);
                packet.gap_before = packet.reopened = reopened && t.count() == 0;
                take(packet);
            }
        };
        send(seen, false);
        const HostTime lost = host;
        for (; host < lost + 60s; host += 20ms) {
            RawPacket silence;
            silence.arrived = host;
            take(silence);
        }
        const SensorTime end_of_silence = end;
        send(1s, true);
        EXPECT_GT(end, end_of_silence + 900ms);
        EXPECT_EQ(resets, 0) << "the frame is kept";
        EXPECT_EQ(counters.snapshot().slicing.late, 0U);
    }
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

}  // namespace
}  // namespace eventide
