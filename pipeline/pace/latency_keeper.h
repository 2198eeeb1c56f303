// How a live line keeps its latency under a bound when more comes than it can take.
#pragma once

#include "src/core/sensor_time.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>

namespace eventide {

/// Learns what a packet, an event window and a frame cost, and decides before data queue up what is
/// left out. In this order, each only where the one before did not do:
///
/// 1. frames that would come too late are not rendered (FrameDropper),
/// 2. the rate of frames is halved, and halved again: what rendering leaves the encoder gets,
/// 3. event windows wait for the encoder together and become one (WindowMerger),
/// 4. packets are not taken, where reading alone is too slow.
///
/// It has no clock: durations come from those who measure, so that tests make them. What one
/// window and one frame take by themselves is the least that any bound can be.
class LatencyKeeper {
public:
    using Duration = HostTime::duration;

    /// Without a bound nothing is left out here.
    explicit LatencyKeeper(std::optional<Duration> bound)
        : bound_s_(bound ? seconds(*bound) : 0), is_bound_(bound.has_value()) {}

    bool is_bound() const noexcept { return is_bound_; }

    /// Read thread: whether one more packet will be parsed in time behind those that wait.
    bool takes_packet(std::size_t waiting) const noexcept {
        return !is_bound_ || double(waiting) * packet_s_.mean() <= kShareOfPackets * bound_s_;
    }

    /// Bin thread: whether a window will be encoded in time behind the `lent` ones that wait for
    /// the encoder or are in its hands. Where not, it is to wait and be merged.
    bool hands_on(std::size_t lent) const noexcept {
        return !is_bound_ || lent == 0 || expected(lent) <= (1 - kShareOfPackets) * bound_s_;
    }

    /// Bin thread, once for each window: chooses the rate of frames.
    void adapt(std::size_t lent) noexcept {
        if (!is_bound_) return;
        const unsigned halvings = halvings_.load(std::memory_order_relaxed);
        // Well before windows are merged (hands_on()), so that the rate of frames gives way first.
        if (lent > 0 && expected(lent) > bound_s_ / 2) {
            calm_ = 0;
            halvings_.store(std::min(halvings + 1, kMaxHalvings), std::memory_order_relaxed);
        } else if (++calm_ >= kCalmWindows && halvings > 0) {
            calm_ = 0;
            halvings_.store(halvings - 1, std::memory_order_relaxed);
        }
    }

    /// Any thread: how often the rate of frames is halved.
    unsigned halvings() const noexcept { return halvings_.load(std::memory_order_relaxed); }

    /// Render thread: how many frames, each in its turn, are ready in time where the window they
    /// lie in is `age` old; nothing where there is no bound or nothing is known.
    std::optional<double> frames_in_time(Duration age) const noexcept {
        if (!is_bound_ || frame_s_.mean() <= 0) return {};
        return std::max(0.0, bound_s_ - seconds(age)) / frame_s_.mean();
    }

    void packet_took(Duration work) noexcept { packet_s_.learn(seconds(work)); }  ///< bin thread
    void window_took(Duration work) noexcept { window_s_.learn(seconds(work)); }  ///< encode thread
    void frame_took(Duration work) noexcept { frame_s_.learn(seconds(work)); }    ///< render thread

private:
    // Of the bound, for parsing and binning; the rest is for the network. More takes longer bursts
    // of packets before any is lost, and merges event windows sooner.
    static constexpr double kShareOfPackets = 0.25;
    // Two: at least a quarter of the frames stays; fewer would leave the network more time, and
    // show motion in larger jumps. Twenty: a second of windows of 50 ms; fewer would make the rate
    // swing where the load is just too high, more would keep frames away for longer than it lasts.
    static constexpr unsigned kMaxHalvings = 2, kCalmWindows = 20;

    /// What something usually takes, learned by one thread and read by others; 0 where nothing is
    /// known. The first ones are slow for reasons of their own (cold memory), and once in a while
    /// the processor is somebody else's for long: neither may make us leave anything out.
    class Usual {
    public:
        double mean() const noexcept { return mean_.load(std::memory_order_relaxed); }
        void learn(double sample) noexcept {
            const double old = mean();
            const bool first = samples_ < kFirst;
            samples_ += first ? 1 : 0;
            mean_.store(old <= 0 ? sample
                        : first  ? std::min(old, sample)
                                 : old + kNewShare * (std::min(sample, kOutlier * old) - old),
                        std::memory_order_relaxed);
        }

    private:
        static constexpr int kFirst = 8;  // samples, of which the least counts
        // A lasting change is learned within some ten samples; a single pause counts as kOutlier
        // times the usual at most. More of either learns sooner, and takes pauses for load.
        static constexpr double kNewShare = 0.2, kOutlier = 4;
        std::atomic<double> mean_{0};
        int samples_ = 0;
    };

    static double seconds(Duration d) { return std::chrono::duration<double>(d).count(); }
    double expected(std::size_t lent) const noexcept {
        return double(lent + 1) * window_s_.mean() + frame_s_.mean();
    }

    const double bound_s_;
    const bool is_bound_;
    Usual packet_s_, window_s_, frame_s_;
    std::atomic<unsigned> halvings_{0};
    unsigned calm_ = 0;  // windows in a row without strain; bin thread
};

}  // namespace eventide
