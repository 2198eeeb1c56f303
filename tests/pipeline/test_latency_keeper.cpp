// The pipeline in made time: a source sends a multiple of what the engine can do, and frames are no
// later than the bound. All decisions are the pipeline's own; only work and waiting are made.
#include "pipeline/frame_clock.h"
#include "pipeline/pace/encoder_gate.h"
#include "pipeline/pace/frame_dropper.h"
#include "pipeline/pace/latency.h"
#include "pipeline/pace/latency_keeper.h"

#include <gtest/gtest.h>

#include <deque>
#include <optional>

namespace eventide {
namespace {

using namespace std::chrono_literals;
using Duration = HostTime::duration;

/// What one of each costs. Two and a half times this many events, and reading alone is too slow.
constexpr Duration kWindowCost = 40ms, kFrameCost = 15ms, kPacketCost = 2ms;
constexpr Duration kStep = 50us, kBound = 250ms;
/// At once the source's pace: a window in the time that the encoder takes for one.
constexpr Duration kWindow = 40ms, kPacket = 5ms;

/// Does one thing at a time, each for as long as it costs.
struct Worker {
    HostTime busy_until{};
    bool idle(HostTime now) const { return now >= busy_until; }
};

/// The pipeline of pipeline.cpp and frame_output.cpp, with made work.
class MadePipeline {
public:
    MadePipeline(double times, std::optional<Duration> bound)
        : keeper_{bound},
          window_{std::chrono::duration_cast<Duration>(kWindow / times)},
          packet_{std::chrono::duration_cast<Duration>(kPacket / times)} {}

    void run(Duration length) {
        for (const HostTime end = now_ + length; now_ < end; now_ += kStep) {
            read();
            bin();
            encode();
            render();
        }
    }

    std::uint64_t sent = 0, lost = 0, parsed = 0, frames = 0, skipped = 0;
    LatencyHistogram latency;
    std::uint64_t merged() const { return gate_.merged(); }
    std::uint64_t waiting() const { return packets_.size() + (parsing_ ? 1 : 0); }
    unsigned most_halvings = 0;

private:
    struct Encoding {
        Window window;
        HostTime arrived;
    };
    struct Lent {
        const MadePipeline* line;
        std::size_t operator()() const { return line->grids_.size() + (line->encoding_ ? 1 : 0); }
    };
    struct HandOn {
        MadePipeline* line;
        void operator()(const EventWindow& event_window) const {
            line->grids_.push_back({event_window.window, event_window.arrived});
        }
    };

    SensorTime sensor_time(HostTime t) const {
        return from_us(
            std::chrono::duration_cast<std::chrono::microseconds>(t.time_since_epoch()).count());
    }
    void read() {
        for (; next_packet_ <= now_; next_packet_ += packet_) {
            ++sent;
            // With everything lent out there is no buffer, whatever the keeper says.
            if (keeper_.takes_packet(packets_.size()) && packets_.size() < 64)
                packets_.push_back(next_packet_);
            else
                ++lost;
        }
    }
    void bin() {
        if (!parser_.idle(now_)) return;
        if (parsing_) {
            cut(*parsing_);
            keeper_.packet_took(kPacketCost);
            parsing_.reset();
            ++parsed;
        }
        gate_.look_again();
        const bool full = !keeper_.is_bound() && grids_.size() >= 3;  // it would wait for a buffer
        if (packets_.empty() || full) return;
        parsing_ = packets_.front();
        packets_.pop_front();
        parser_.busy_until = now_ + kPacketCost;
    }
    void cut(HostTime arrived) {
        for (; window_end_ <= arrived; window_end_ += window_) {
            EventWindow event_window;
            event_window.window = {sensor_time(window_end_ - window_), sensor_time(window_end_)};
            event_window.arrived = arrived;
            gate_.take(event_window);
            most_halvings = std::max(most_halvings, keeper_.halvings());
        }
    }
    void encode() {
        if (!encoder_.idle(now_)) return;
        if (encoding_) {
            latents_.push_back(*encoding_);
            keeper_.window_took(kWindowCost);
            encoding_.reset();
        }
        if (grids_.empty() || latents_.size() >= 3) return;
        encoding_ = grids_.front();
        grids_.pop_front();
        encoder_.busy_until = now_ + kWindowCost;
    }
    void render() {
        if (!renderer_.idle(now_)) return;
        if (rendering_) finish_frame();
        while (!rendering_) {
            if (schedule_.due() == 0 && !open_next()) return;
            while (schedule_.due() > 0 && !rendering_) {
                schedule_.next();
                if (dropper_.keeps_next(latents_.size()))
                    rendering_ = true;
                else
                    ++skipped;
            }
        }
        renderer_.busy_until = now_ + kFrameCost;
    }
    void finish_frame() {
        rendering_ = false;
        ++frames;
        dropper_.took(kFrameCost);
        keeper_.frame_took(kFrameCost);
        // What has to be learned first is not the bound's.
        if (now_.time_since_epoch() > 1s) latency.record(now_ - arrived_);
    }
    bool open_next() {
        if (latents_.empty()) return false;
        const Encoding next = latents_.front();
        latents_.pop_front();
        arrived_ = next.arrived;
        schedule_.open(next.window);
        dropper_.open({schedule_.next_index(), schedule_.due(), keeper_.halvings(),
                       keeper_.frames_in_time(now_ - arrived_)},
                      now_);
        return true;
    }

    HostTime now_{}, next_packet_{}, arrived_{};
    LatencyKeeper keeper_;
    Duration window_, packet_;
    HostTime window_end_{window_};
    Worker parser_, encoder_, renderer_;
    std::deque<HostTime> packets_;
    std::optional<HostTime> parsing_;
    std::deque<Encoding> grids_, latents_;
    std::optional<Encoding> encoding_;
    EncoderGate<Lent, HandOn> gate_{keeper_, {}, Lent{this}, HandOn{this}};
    FrameSchedule schedule_{{60, 1}};
    FrameDropper dropper_{2};
    bool rendering_ = false;
};

TEST(LatencyKeeper, HoldsItsBoundHoweverMuchComes) {
    for (const double times : {0.5, 1.0, 2.0, 5.0, 20.0}) {
        SCOPED_TRACE(times);
        MadePipeline line{times, kBound};
        line.run(60s);
        EXPECT_LT(line.latency.summary().p99, kBound + kWindow);
        EXPECT_GT(line.frames, 60U * 10) << "and frames come";
        EXPECT_EQ(line.sent, line.parsed + line.lost + line.waiting()) << "each loss is counted";
        EXPECT_EQ(line.lost == 0, times <= 2) << line.lost;
        EXPECT_EQ(line.merged() == 0, times < 2) << line.merged();
    }
}

TEST(LatencyKeeper, WithoutABoundLatencyIsWhatTheBuffersHoldAndDataAreLost) {
    MadePipeline line{2, {}};
    line.run(60s);
    EXPECT_GT(line.latency.summary().p50, kBound) << "else this test would show nothing";
    EXPECT_GT(line.lost, 0U);
}

TEST(LatencyKeeper, LeavesOutInTheDocumentedOrder) {
    MadePipeline easy{0.5, kBound};
    easy.run(60s);
    EXPECT_EQ(easy.most_halvings, 0U);
    MadePipeline twice{2, kBound};
    twice.run(60s);
    EXPECT_GT(twice.skipped, 0U);
    EXPECT_GT(twice.most_halvings, 0U);
    EXPECT_GT(twice.merged(), 0U);
    EXPECT_EQ(twice.lost, 0U);
}

TEST(LatencyKeeper, HalvesTheRateBeforeItMergesAndRestoresItWhenItIsCalm) {
    LatencyKeeper keeper{200ms};
    for (int i = 0; i < 8; ++i) keeper.window_took(35ms);
    keeper.frame_took(20ms);
    EXPECT_TRUE(keeper.hands_on(1));
    keeper.adapt(1);
    EXPECT_EQ(keeper.halvings(), 0U) << "90 ms of 200";
    keeper.window_took(135ms);  // the mean goes to 55 ms
    keeper.adapt(1);
    EXPECT_EQ(keeper.halvings(), 1U) << "130 ms are more than half";
    EXPECT_TRUE(keeper.hands_on(1));
    EXPECT_FALSE(keeper.hands_on(2)) << "185 ms leave too little for packets";
    for (int i = 0; i < 20; ++i) keeper.adapt(0);
    EXPECT_EQ(keeper.halvings(), 0U);
}

TEST(LatencyKeeper, TwentyWindowsInARowMustBeCalmBeforeTheRateGoesUp) {
    LatencyKeeper keeper{200ms};
    for (int i = 0; i < 8; ++i) keeper.window_took(60ms);
    const auto strain = [&] { keeper.adapt(1); };
    const auto calm = [&](int windows) {
        for (int i = 0; i < windows; ++i) keeper.adapt(0);
        return keeper.halvings();
    };
    for (int i = 0; i < 5; ++i) strain();
    EXPECT_EQ(keeper.halvings(), 2U) << "and no further";
    EXPECT_EQ(calm(19), 2U);
    strain();
    EXPECT_EQ(calm(19), 2U) << "they count anew";
    EXPECT_EQ(calm(1), 1U);
    EXPECT_EQ(calm(19), 1U) << "one halving at a time";
    EXPECT_EQ(calm(1), 0U);
}

TEST(LatencyKeeper, OneLongPauseMakesItLeaveNothingOut) {
    LatencyKeeper keeper{200ms};
    keeper.packet_took(300ms);  // the first, all memory is cold
    for (int i = 0; i < 8; ++i) keeper.packet_took(100us);
    EXPECT_TRUE(keeper.takes_packet(64));
    keeper.packet_took(1s);
    EXPECT_TRUE(keeper.takes_packet(64)) << "the backlog is soon parsed";
    for (int i = 0; i < 20; ++i) keeper.packet_took(10ms);
    EXPECT_FALSE(keeper.takes_packet(64)) << "it has become slow for good";
}

TEST(LatencyKeeper, LearnsFromTheQuickestOfTheFirst) {
    LatencyKeeper keeper{200ms};
    keeper.packet_took(1ms);
    for (int i = 0; i < 7; ++i) keeper.packet_took(30ms);  // memory of its own is cold
    EXPECT_TRUE(keeper.takes_packet(50));
    EXPECT_FALSE(keeper.takes_packet(51));
    keeper.packet_took(30ms);  // the ninth counts a fifth, of 4 ms at most: 1.6 ms
    EXPECT_TRUE(keeper.takes_packet(31));
    EXPECT_FALSE(keeper.takes_packet(32));
}

TEST(LatencyKeeper, AnIdleEncoderTakesAWindowHoweverLongItWillBusyIt) {
    LatencyKeeper keeper{200ms};
    for (int i = 0; i < 8; ++i) keeper.window_took(400ms);
    EXPECT_TRUE(keeper.hands_on(0)) << "waiting would make it no sooner";
    EXPECT_FALSE(keeper.hands_on(1));
    keeper.adapt(0);
    EXPECT_EQ(keeper.halvings(), 0U) << "nor would fewer frames";
}

TEST(LatencyKeeper, AWindowHasThreeQuartersOfTheBoundForThoseBeforeItItselfAndItsFrame) {
    for (const auto frame : {45ms, 55ms}) {
        LatencyKeeper keeper{200ms};
        keeper.window_took(50ms);
        keeper.frame_took(frame);
        EXPECT_EQ(keeper.hands_on(1), frame == 45ms);
    }
}

TEST(LatencyKeeper, NoFrameOfAWindowOlderThanTheBoundIsInTime) {
    LatencyKeeper keeper{200ms};
    EXPECT_FALSE(keeper.frames_in_time(0ms)) << "nothing is known";
    keeper.frame_took(20ms);
    EXPECT_NEAR(keeper.frames_in_time(100ms).value(), 5, 1e-9);
    EXPECT_EQ(keeper.frames_in_time(1s), 0);
    EXPECT_FALSE((LatencyKeeper{{}}.frames_in_time(0ms)));
}

TEST(LatencyKeeper, TakesPacketsWhileTheyCanBeParsedInTime) {
    LatencyKeeper keeper{200ms};
    EXPECT_TRUE(keeper.takes_packet(64)) << "nothing is known";
    keeper.packet_took(5ms);
    EXPECT_TRUE(keeper.takes_packet(10));
    EXPECT_FALSE(keeper.takes_packet(11));
    EXPECT_TRUE((LatencyKeeper{{}}.takes_packet(1000)));
}

EventWindow event_window_of(std::int64_t begin_us, std::int64_t end_us,
                            const std::vector<Event>& events) {
    EventWindow event_window;
    event_window.window = {from_us(begin_us), from_us(end_us)};
    event_window.events = events;
    event_window.arrived = HostTime{std::chrono::microseconds{end_us}};
    return event_window;
}

TEST(EncoderGate, NeverHasMoreWindowsWithTheEncoderThanThereAreBuffers) {
    // Nothing is known yet, so no window is thought to be late; but a fourth would wait.
    LatencyKeeper keeper{200ms};
    std::size_t lent = 0;
    EncoderGate gate{
        keeper, {.most = 3}, [&] { return lent; }, [&](const EventWindow&) { ++lent; }};
    for (int k = 0; k < 6; ++k) gate.take(event_window_of(10'000 * k, 10'000 * (k + 1), {}));
    EXPECT_EQ(lent, 3U);
    EXPECT_EQ(gate.merged(), 2U) << "the fourth waits, and two more with it";
    lent = 2;
    gate.look_again();
    EXPECT_EQ(lent, 3U);
}

TEST(EncoderGate, WindowsThatWaitGoOnBeforeAndWithTheNext) {
    LatencyKeeper keeper{200ms};
    std::size_t lent = 1;
    std::vector<Window> given;
    EncoderGate gate{
        keeper,
        {.most = 1},
        [&] { return lent; },
        [&](const EventWindow& event_window) { given.push_back(event_window.window); }};
    gate.take(event_window_of(0, 10, {}));
    EXPECT_TRUE(given.empty());
    lent = 0;
    gate.take(event_window_of(10, 20, {}));
    EXPECT_EQ(given, (std::vector<Window>{{from_us(0), from_us(20)}}));
}

TEST(EncoderGate, NothingIsMergedOverAGapWhereStateBeginsAnew) {
    for (const bool anew : {false, true}) {
        LatencyKeeper keeper{200ms};
        std::vector<Window> given;
        EncoderGate gate{
            keeper,
            {.most = 1, .new_state_after_gaps = anew},
            [] { return std::size_t{1}; },
            [&](const EventWindow& event_window) { given.push_back(event_window.window); }};
        EventWindow after_gap = event_window_of(10, 20, {});
        after_gap.gap_before = true;
        gate.take(event_window_of(0, 10, {}));
        gate.take(after_gap);
        EXPECT_EQ(given.size(), anew ? 1U : 0U) << "goes on, whatever the encoder has to do";
        gate.flush();
        EXPECT_EQ(given.back(), (Window{from_us(anew ? 10 : 0), from_us(20)}));
    }
}

TEST(EncoderGate, AWindowThatWaitsKnowsNoImageOfTheClockThatBeginsAnew) {
    LatencyKeeper keeper{200ms};
    std::vector<std::uint64_t> images;
    EncoderGate gate{keeper,
                     {.most = 1},
                     [] { return std::size_t{1}; },
                     [&](const CutWindow& event_window) { images.push_back(event_window.images); }};
    CutWindow anew{event_window_of(0, 10, {}), 5};
    anew.reset_before = true;
    gate.take({event_window_of(500, 510, {}), 1});
    gate.take({event_window_of(510, 520, {}), 2});
    gate.take(anew);
    EXPECT_EQ(images, (std::vector<std::uint64_t>{2})) << "as the last of those that became one";
    gate.flush();
    EXPECT_EQ(images.back(), 5U);
}

TEST(WindowMerger, IsAllItsWindowsAndNothingElse) {
    const std::vector<Event> first{{from_us(3), 1, 2, Polarity::on}},
        second{{from_us(15), 3, 4, Polarity::off}};
    WindowMerger merger{2};
    EXPECT_TRUE(merger.empty());
    EventWindow broken = event_window_of(10, 20, second);
    broken.gap_before = true;
    merger.add(event_window_of(0, 10, first));
    EXPECT_TRUE(merger.takes(broken, false));
    EXPECT_FALSE(merger.takes(broken, true)) << "state begins anew there";
    EventWindow reset = event_window_of(0, 20, second);
    reset.reset_before = true;
    EXPECT_FALSE(merger.takes(reset, false));
    merger.add(broken);
    EXPECT_FALSE(merger.takes(event_window_of(20, 30, first), false)) << "enough events";
    const EventWindow merged = merger.take();
    EXPECT_EQ(merged.window, (Window{from_us(0), from_us(20)}));
    EXPECT_EQ(merged.events.size(), 2U);
    EXPECT_EQ(merged.events[1].x, 3);
    EXPECT_TRUE(merged.gap_before);
    EXPECT_EQ(merged.arrived, broken.arrived) << "of the newest packet in it";
    EXPECT_TRUE(merger.empty());
    merger.add(event_window_of(20, 30, first));
    EXPECT_EQ(merger.take().events.size(), 1U);
    merger.add(broken);
    merger.add(event_window_of(20, 30, {}));
    EXPECT_TRUE(merger.take().gap_before) << "before the first of them";
}

}  // namespace
}  // namespace eventide
