// Frames are rendered when the latent maps they need are there, and with no other.
#include "pipeline/frame_output.h"
#include "src/core/error.h"
#include "tests/support/toy_stages.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace eventide {
namespace {

using namespace test;

/// Event windows of 10 us from `begin_us` on, given one by one.
struct Ending {
    explicit Ending(int lookahead, FrameRate rate = {200'000, 1},  // a frame each 5 us
                    bool allow_silence = false)
        : output(
              renderer, {&sink}, {rate, {}, lookahead, false, 1, allow_silence, &changes},
              [] { return 0; }, stop, counters, keeper) {
        sink.before_write = [this](auto) {
            pushed.push_back(renderer.pushed());
            lookaheads.push_back(sink.lookahead);
        };
    }
    void give_after_gap(std::int64_t begin_us) { give(begin_us, false, true); }
    void give(std::int64_t begin_us, bool reset_before = false, bool gap_before = false) {
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(begin_us), from_us(begin_us + 10)};
        encoded.latent.events = 1;
        encoded.latent.reset_before = reset_before;
        encoded.latent.gap_before = gap_before;
        output.take(encoded);
    }
    void give_silence(std::int64_t begin_us, std::int64_t end_us) {
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(begin_us), from_us(end_us)};
        output.take(encoded);
    }
    std::vector<std::int64_t> times() const {
        std::vector<std::int64_t> times;
        for (const auto& seen : sink.seen) times.push_back(seen.t_us);
        return times;
    }

    ToyRenderer renderer;
    ToySink sink;
    std::vector<std::size_t> pushed;  // latent maps the renderer had, per frame
    std::vector<int> lookaheads;      // what the sink had been told, per frame
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    LiveChanges changes;
    FrameOutput output;
};

TEST(FrameOutput, RendersEachFrameWithItsLookahead) {
    for (const int lookahead : {0, 1, 2}) {
        Ending e(lookahead);
        for (int k = 0; k < 4; ++k) e.give(10 * k);
        const auto before_end = e.sink.seen.size();
        EXPECT_EQ(before_end, std::size_t(1 + 2 * (4 - lookahead)));
        e.output.finish();
        EXPECT_TRUE(e.renderer.finished);
        EXPECT_EQ(e.times(), (std::vector<std::int64_t>{0, 5, 10, 15, 20, 25, 30, 35, 40}));
        for (std::size_t i = 0; i < before_end; ++i) {
            const std::size_t k = i == 0 ? 1 : (i + 1) / 2;  // the event window, from 1
            EXPECT_EQ(e.pushed[i], k + std::size_t(lookahead)) << i;
        }
        for (const auto& seen : e.sink.seen) {
            EXPECT_LE(seen.t_us, seen.end_us);
            EXPECT_GE(seen.t_us, seen.begin_us);
        }
    }
}

TEST(FrameOutput, GivesNoneOneOrManyFramesPerEventWindow) {
    Ending seldom(0, {40'000, 1});  // each 25 us
    for (int k = 0; k < 6; ++k) seldom.give(10 * k);
    EXPECT_EQ(seldom.times(), (std::vector<std::int64_t>{0, 25, 50}));
    Ending often(0, {1'000'000, 1});
    for (int k = 0; k < 6; ++k) often.give(10 * k);
    EXPECT_EQ(often.sink.seen.size(), 61U);
    Ending without_rate(1, {});
    for (int k = 0; k < 3; ++k) without_rate.give(10 * k);
    without_rate.output.finish();
    EXPECT_EQ(without_rate.times(), (std::vector<std::int64_t>{10, 20, 30}));
}

TEST(FrameOutput, TellsOfAGapBeforeAWindowWithoutFramesWithTheNextFrame) {
    Ending e(0, {40'000, 1});  // each 25 us
    e.give(0);
    e.give_after_gap(10);
    for (int k = 2; k < 6; ++k) e.give(10 * k);
    ASSERT_EQ(e.times(), (std::vector<std::int64_t>{0, 25, 50}));
    EXPECT_FALSE(e.sink.seen[0].gap);
    EXPECT_TRUE(e.sink.seen[1].gap) << "the window before had no frame";
    EXPECT_FALSE(e.sink.seen[2].gap) << "told once";
}

TEST(FrameOutput, TellsOfAGapWithAllFramesOfItsWindow) {
    Ending e(0);  // each 5 us
    e.give(0);
    e.give_after_gap(10);
    e.give(20);
    std::vector<bool> gaps;
    for (const auto& seen : e.sink.seen) gaps.push_back(seen.gap);
    EXPECT_EQ(gaps, (std::vector<bool>{false, false, false, true, true, false, false}));
}

TEST(FrameOutput, FinishesTheOldStreamBeforeANewOne) {
    Ending e(2);
    for (int k = 0; k < 3; ++k) e.give(1000 + 10 * k);
    e.give(3, true);
    EXPECT_EQ(e.times().back(), 1030);
    EXPECT_EQ(e.renderer.pushed(), 1U);
    e.output.finish();
    EXPECT_EQ(e.times().back(), 13);
    for (std::size_t i = 0; i < e.sink.seen.size(); ++i) EXPECT_EQ(e.sink.seen[i].index, i);
}

TEST(FrameOutput, StopsBeforeFramesWithoutEnd) {
    Ending e(0);
    e.give(0);
    e.give_silence(10, 1000);
    const auto before = e.sink.count;
    try {
        e.give_silence(1000, 1'633'953'690'975'950);  // 54 years
        FAIL() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_NE(std::string(error.what()).find("--allow-silence"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("from 1000 to 1633953690975950 us"),
                  std::string::npos);
    }
    EXPECT_EQ(e.sink.count, before);
}

TEST(FrameOutput, CountsSilenceInARowAndOnlyWhereItIsNotAllowed) {
    for (const bool allowed : {false, true}) {
        Ending e(0, {1'000'000, 1}, allowed);
        e.sink.keeps = false;
        e.sink.before_write = nullptr;
        e.give_silence(0, 600'000);
        e.give(600'000);
        e.give_silence(600'010, 1'200'000);
        if (allowed)
            e.give_silence(1'200'000, 1'800'000);
        else
            EXPECT_THROW(e.give_silence(1'200'000, 1'800'000), Error);
        EXPECT_EQ(e.sink.count, allowed ? 1'800'001U : 1'200'001U);
    }
}

TEST(FrameOutput, ALiveSourceMayBeSilentForHours) {
    ToyRenderer renderer;
    ToySink sink;
    sink.keeps = false;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    FrameOutput output(
        renderer, {&sink}, {.rate = {1'000'000, 1}, .live = true, .halvings = 10}, [] { return 0; },
        stop, counters, keeper);
    Encoded encoded;
    encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
    encoded.latent.window = {from_us(0), from_us(SilenceGuard::kMost + 1)};
    EXPECT_TRUE(output.take(encoded));
    EXPECT_GT(sink.count, 0U);
}

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

/// Its third frame has a NaN, in its intensity or its sigma.
class BreakingRenderer final : public RenderStage {
public:
    explicit BreakingRenderer(bool in_sigma) : in_sigma_(in_sigma) {}
    Frame make_output() const override { return good_.make_output(); }
    void take(LatentMap& latent) noexcept override { good_.take(latent); }
    void finish() noexcept override { good_.finish(); }
    void reset() noexcept override { good_.reset(); }
    void render(SensorTime t, const Window& window, Frame& frame) noexcept override {
        good_.render(t, window, frame);
        if (in_sigma_ && frame.sigma.empty()) frame.sigma = frame.intensity;
        if (++rendered_ == 3)
            (in_sigma_ ? frame.sigma : frame.intensity)(1, 2) =
                std::numeric_limits<float>::quiet_NaN();
    }

private:
    bool in_sigma_;
    ToyRenderer good_;
    int rendered_ = 0;
};

TEST(FrameOutput, WritesNoFrameThatIsNotFinite) {
    for (const bool in_sigma : {false, true}) {
        BreakingRenderer renderer{in_sigma};
        ToySink sink;
        StopRequest stop;
        Counters counters;
        LatencyKeeper keeper{{}};
        FrameOutput output(
            renderer, {&sink}, {{200'000, 1}, {}, 0, false, 1}, [] { return 0; }, stop, counters,
            keeper);
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(0), from_us(100)};
        try {
            output.take(encoded);
            FAIL() << "nothing was thrown";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::input);
            EXPECT_NE(std::string(error.what()).find("frame 2, at 10 us"), std::string::npos);
        }
        EXPECT_EQ(sink.count, 2U);
        EXPECT_EQ(counters.snapshot().broken_frames, 1U);
    }
}

TEST(FrameOutput, StopsWhenASinkWantsNoMore) {
    Ending e(0);
    e.sink.wants = 3;
    for (int k = 0; k < 4; ++k) e.give(10 * k);
    EXPECT_EQ(e.sink.count, 3U);
}

TEST(FrameOutput, RefusesAnImpossibleLookahead) {
    for (const int lookahead : {-1, 3}) EXPECT_THROW(Ending{lookahead}, Error);
}

TEST(FrameOutput, ChangesItsRateWhileItRuns) {
    Ending e(0);
    e.give(0);
    e.changes.set_rate({100'000, 1});  // a frame each 10 us
    e.give(10);
    e.give(20);
    EXPECT_EQ(e.times(), (std::vector<std::int64_t>{0, 5, 10, 20, 30}));
    for (std::size_t i = 0; i < e.sink.seen.size(); ++i) EXPECT_EQ(e.sink.seen[i].index, i);
}

TEST(FrameOutput, RendersEverySecondFrameWhereThatIsAskedFor) {
    Ending e(0);
    e.give(0);
    e.changes.set_halvings(1);
    e.give(10);
    e.changes.set_halvings(2);
    e.give(20);
    e.changes.set_halvings(0);
    e.give(30);
    EXPECT_EQ(e.times(), (std::vector<std::int64_t>{0, 5, 10, 20, 35, 40}));
    for (const auto& seen : e.sink.seen) EXPECT_EQ(std::int64_t(seen.index) * 5, seen.t_us);
    EXPECT_EQ(e.counters.present.skipped_frames.value(), 3U);
}

TEST(FrameOutput, OfALiveSourceRendersEverySecondFrameWhereThatIsAskedFor) {
    ToyRenderer renderer;
    ToySink sink;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{{}};
    FrameOutput output(
        renderer, {&sink}, {.rate = {200'000, 1}, .live = true, .halvings = 1}, [] { return 0; },
        stop, counters, keeper);
    Encoded encoded;
    encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
    encoded.latent.window = {from_us(0), from_us(20)};
    output.take(encoded);
    EXPECT_EQ(sink.count, 3U) << "of 0, 5, 10, 15 and 20 us";
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

TEST(FrameOutput, LearnsWhatAFrameTakesAndRendersNoneThatWouldBeLateButTheNewest) {
    ToyRenderer renderer;
    ToySink sink;
    StopRequest stop;
    Counters counters;
    LatencyKeeper keeper{std::chrono::nanoseconds{1}};
    FrameOutput output(
        renderer, {&sink}, {.rate = {200'000, 1}, .live = true}, [] { return 0; }, stop, counters,
        keeper);
    for (const std::int64_t begin_us : {0, 100}) {
        Encoded encoded;
        encoded.latent.values = Array3<float>(kToyHeight, kToyWidth, 2);
        encoded.latent.window = {from_us(begin_us), from_us(begin_us + 100)};
        output.take(encoded);
    }
    EXPECT_EQ(sink.count, 21U + 1U) << "as yet nothing was known of the first window's";
    EXPECT_EQ(sink.seen.back().t_us, 200);
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

TEST(FrameOutput, ChangesItsLookaheadWithoutLosingAFrame) {
    Ending e(2);
    for (int k = 0; k < 4; ++k) e.give(10 * k);
    EXPECT_EQ(e.times().back(), 20) << "two event windows are waited for";
    e.changes.set_lookahead(0);
    e.give(40);
    EXPECT_EQ(e.times().back(), 50) << "none is waited for";
    e.changes.set_lookahead(1);
    e.give(50);
    EXPECT_EQ(e.times().back(), 50);
    e.give(60);
    EXPECT_EQ(e.times().back(), 60);
    e.output.finish();
    EXPECT_EQ(e.times().size(), 15U);
    EXPECT_EQ(e.lookaheads, (std::vector<int>{2, 2, 2, 2, 2, 2, 2, 1, 1, 0, 0, 1, 1, 0, 0}));
    for (std::size_t i = 0; i < e.sink.seen.size(); ++i) EXPECT_EQ(e.sink.seen[i].index, i);
}

TEST(FrameOutput, KeepsItsLookaheadWhereOneIsAskedForThatThereIsNot) {
    for (const int impossible : {3, 1000, -1}) {
        Ending e(1);
        e.changes.set_lookahead(impossible);
        for (int k = 0; k < 4; ++k) e.give(10 * k);
        EXPECT_EQ(e.times().back(), 30) << impossible << ": all but the last window's frames";
    }
}

TEST(FrameOutput, KeepsWhatItsRendererCannotChange) {
    Ending e(2);
    e.renderer.changeable = false;
    e.changes.set_lookahead(0);
    e.changes.set_size(640, 480);
    for (int k = 0; k < 3; ++k) e.give(10 * k);
    EXPECT_EQ(e.times().back(), 10);
}

}  // namespace
}  // namespace eventide
