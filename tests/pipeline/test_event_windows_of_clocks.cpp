// Event windows of sources whose clocks stand still, run ahead, or begin anew.
#include "src/codec/prophesee/evt3.h"
#include "src/core/byte_order.h"
#include "tests/pipeline/event_windows_by_hand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

namespace eventide {
namespace {

using namespace std::chrono_literals;
using namespace test;

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

std::unique_ptr<Parser> own_clock_parser() {
    return std::make_unique<OwnClockParser>();
}

/// Live; packets are given by hand.
class ParsedBy final : public Source {
public:
    using MakeParser = std::unique_ptr<Parser> (*)();
    explicit ParsedBy(MakeParser make) : make_(make) {
        info_.width = kToyWidth;
        info_.height = kToyHeight;
    }
    const SensorInfo& info() const override { return info_; }
    bool is_live() const noexcept override { return true; }
    ReadStatus read(RawPacket&) override { return ReadStatus::end; }
    void stop() noexcept override {}
    std::unique_ptr<Parser> make_parser() const override { return make_(); }

private:
    SensorInfo info_;
    MakeParser make_;
};

TEST(EventWindows, GoOnWithASourceWhoseOwnClockPromisedTooMuch) {
    constexpr std::int64_t kMs = 1000;
    const ParsedBy source{own_clock_parser};
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

/// One datagram of another time, or a sender whose clock was set.
TEST(EventWindows, OfALiveSourceBeginAnewWhereItsClockLeaps) {
    constexpr std::int64_t kMs = 1000, kYear = 31'536'000'000'000;
    const auto windows_of = [](std::int64_t leap_us, std::int64_t silence_us, bool live) {
        Beginning b(live, 10 * kMs);
        std::int64_t host = 0;
        for (std::int64_t t = 1; t < 100 * kMs; t += 5 * kMs)
            b.give(record(ToyKind::event, t), host += 5 * kMs);
        host += silence_us;
        for (std::int64_t t = 100 * kMs + leap_us; t < 200 * kMs + leap_us; t += 5 * kMs)
            b.give(record(ToyKind::event, t), host += 5 * kMs);
        b.finish();
        return std::pair{b.counters.snapshot().slicing.time_resets, b.edges};
    };
    for (const bool live : {true, false}) {
        const auto [resets, edges] = windows_of(50 * kYear, 0, live);
        EXPECT_EQ(resets, live ? 1U : 0U) << "a recording may have been paused";
        if (!live) continue;
        for (const auto& [begin, end] : edges) EXPECT_LE(end - begin, 10 * kMs);
    }
    EXPECT_EQ(windows_of(59'000 * kMs, 0, true).first, 0U) << "sent faster than it was seen";
    EXPECT_EQ(windows_of(3'600'000 * kMs, 3'600'000 * kMs, true).first, 0U) << "an hour's silence";
    EXPECT_EQ(windows_of(3'600'000 * kMs, 0, true).first, 1U);
}

TEST(EventWindows, OfALiveSourceThatWasSilentBeginAnewWhereItsClockLeapsLater) {
    constexpr std::int64_t kMs = 1000, kHour = 3'600'000 * kMs;
    Beginning b(true, 10 * kMs);
    b.give(record(ToyKind::event, 1), 0);
    b.give(record(ToyKind::event, kHour), kHour);
    EXPECT_EQ(b.counters.snapshot().slicing.time_resets, 0U);
    b.give(record(ToyKind::event, 3 * kHour), kHour + kMs);
    EXPECT_EQ(b.counters.snapshot().slicing.time_resets, 1U) << "no time had passed";
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

/// Of a sensor behind V4L2: times of 24 bits.
std::unique_ptr<Parser> evt3_parser() {
    return std::make_unique<Evt3Parser>(kToyWidth, kToyHeight);
}

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
        const ParsedBy source{evt3_parser};
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

}  // namespace
}  // namespace eventide
