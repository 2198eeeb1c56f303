// What sinks get, and what they say to it.
#include "tests/pipeline/frame_output_by_hand.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

namespace eventide {
namespace {

using namespace test;

/// A sink somebody watches from time to time.
class WatchedSink final : public Sink {
public:
    void write(const Frame& frame) override { times_us.push_back(to_us(frame.t)); }
    bool is_watched() const override { return watched; }

    bool watched = true;
    std::vector<std::int64_t> times_us;
};

TEST(FrameOutput, RendersNothingThatNobodyWatches) {
    ToyRenderer renderer;
    WatchedSink first, second;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    FrameOutput output(
        renderer, {&first, &second}, {{100'000, 1}, {}, 0, false, 1, false}, [] { return 0; }, stop,
        counters, keeper);
    for (int k = 0; k < 6; ++k) {
        first.watched = k < 2 || k == 5;
        second.watched = k == 5;
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(10 * k), from_us(10 * k + 10)};
        encoded.latent.events = 1;
        output.take(encoded);
    }
    EXPECT_EQ(first.times_us, (std::vector<std::int64_t>{0, 10, 20, 60}));
    EXPECT_EQ(second.times_us, first.times_us) << "what one of them watches all get";
    EXPECT_EQ(counters.snapshot().skipped_frames, 3U);
    EXPECT_EQ(renderer.pushed(), 6U) << "the network goes on";
}

TEST(FrameOutput, ClosesAllSinksThoughOneFails) {
    ToyRenderer renderer;
    ToySink bad, good;
    bad.before_close = [] { throw std::runtime_error("close"); };
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    FrameOutput output(
        renderer, {&bad, &good}, {}, [] { return 0; }, stop, counters, keeper);
    EXPECT_THROW(output.close(), std::runtime_error);
    EXPECT_EQ(good.closed, 1);
}

TEST(FrameOutput, StopsWhenASinkWantsNoMore) {
    FrameOutputByHand e(0);
    e.sink.wants = 3;
    for (int k = 0; k < 4; ++k) e.give(10 * k);
    EXPECT_EQ(e.sink.count, 3U);
}

TEST(FrameOutput, StopsWhenOneOfItsSinksWantsNoMore) {
    ToyRenderer renderer;
    ToySink first, second;
    first.wants = 2;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    FrameOutput output(
        renderer, {&first, &second}, {.rate = {200'000, 1}}, [] { return 0; }, stop, counters,
        keeper);
    Encoded encoded;
    encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
    encoded.latent.window = {from_us(0), from_us(20)};
    EXPECT_FALSE(output.take(encoded));
    EXPECT_EQ(second.count, 2U);
}

/// A sink before which somebody looks at each frame for an hour.
class HoldingSink final : public Sink {
public:
    void write(const Frame& frame) override { arrived.push_back(frame.arrived); }
    HostTime::duration held() const override { return std::chrono::hours{1}; }

    std::vector<HostTime> arrived;
};

TEST(FrameOutput, LatencyCountsFromTheNewestDataAndWithoutPauses) {
    ToyRenderer renderer;
    HoldingSink sink;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    FrameOutput output(
        renderer, {&sink}, {.rate = {100'000, 1}}, [] { return 0; }, stop, counters, keeper);
    const HostTime begun = std::chrono::steady_clock::now();
    const std::vector<HostTime> arrived{begun, begun + std::chrono::microseconds{10}};
    for (int k = 0; k < 2; ++k) {
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(10 * k + 1), from_us(10 * k + 10)};
        encoded.latent.arrived = arrived[std::size_t(k)];
        output.take(encoded);
    }
    EXPECT_EQ(sink.arrived, arrived);
    EXPECT_EQ(counters.snapshot().latency.max.count(), 0) << "frames came an hour before that";
}

class PreviewSink final : public Sink {
public:
    void write(const Frame& frame) override { shown.push_back(frame.event_preview(0, 0)); }
    std::vector<float> shown;
};

TEST(FrameOutput, EveryFrameOfAWindowShowsThatWindowsEvents) {
    ToyRenderer renderer;
    PreviewSink sink;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    FrameOutput output(
        renderer, {&sink}, {.rate = {200'000, 1}, .lookahead = 1}, [] { return 0; }, stop, counters,
        keeper);
    for (int k = 0; k < 4; ++k) {
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(10 * k), from_us(10 * k + 10)};
        encoded.event_preview = Array2<float>(kToyHeight, kToyWidth);
        encoded.event_preview(0, 0) = float(k);
        output.take(encoded);
    }
    output.finish();
    EXPECT_EQ(sink.shown, (std::vector<float>{0, 0, 0, 1, 1, 2, 2, 3, 3}));
}

}  // namespace
}  // namespace eventide
