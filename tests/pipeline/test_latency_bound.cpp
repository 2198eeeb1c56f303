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

TEST(LatencyBound, HoldsItsBoundHoweverMuchComes) {
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

TEST(LatencyBound, WithoutABoundLatencyIsWhatTheBuffersHoldAndDataAreLost) {
    MadePipeline line{2, {}};
    line.run(60s);
    EXPECT_GT(line.latency.summary().p50, kBound) << "else this test would show nothing";
    EXPECT_GT(line.lost, 0U);
}

TEST(LatencyBound, LeavesOutInTheDocumentedOrder) {
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

}  // namespace
}  // namespace eventide
