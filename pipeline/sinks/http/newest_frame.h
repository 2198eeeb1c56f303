// The newest frame, for any number of viewers of any slowness: a frame is copied only where one of
// them waits for it, and nobody waits for a viewer.
#pragma once

#include "pipeline/sinks/http/shown_frame.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <vector>

namespace eventide {

class NewestFrame {
public:
    using Clock = std::chrono::steady_clock;
    /// Viewers that come this soon after a frame was copied get that one, if they have not seen it,
    /// and share its encodings.
    static constexpr std::chrono::milliseconds kFresh{12};

    explicit NewestFrame(float sigma_white) : sigma_white_{sigma_white} {}

    /// Render thread.
    void offer(const Frame& frame);
    /// Render thread: the same frame as before goes to whoever came meanwhile (a pause). Waits for
    /// such a one, for `most` at most.
    void offer_while_held(const Frame& frame, std::chrono::milliseconds most);

    /// A viewer's thread: a frame that `seen` (a viewer's own, null at first) is not; null where
    /// none came in time, or it is closed. A frame that is held comes once to each viewer.
    std::shared_ptr<const ShownFrame> next(const std::shared_ptr<const ShownFrame>& seen,
                                           Clock::time_point until);
    /// A viewer's thread: false where it was closed before.
    bool sleep(Clock::time_point until);

    /// Any thread: nobody waits any more.
    void close();
    bool is_closed() const;
    std::uint64_t copied() const { return copied_frames_; }

private:
    /// Frames that nobody shows any more: fresh memory would cost the render thread a page fault
    /// for each 4 KiB.
    struct Spare {
        static constexpr std::size_t kMax = 4;
        Spare() { frames.reserve(kMax); }  // giving back may not fail
        std::mutex mutex;
        std::vector<Frame> frames;
        Frame take();
        void give_back(Frame frame);
    };
    void publish(const Frame& frame);
    std::shared_ptr<const ShownFrame> copy_of(const Frame& frame, Clock::time_point now);

    const std::shared_ptr<Spare> spare_ = std::make_shared<Spare>();

    const float sigma_white_;
    mutable std::mutex mutex_;
    std::condition_variable came_, wanted_;
    std::shared_ptr<const ShownFrame> newest_;  // the last that was copied
    Clock::time_point copied_{};
    bool held_ = false;  // newest_ is what is offered again and again
    std::atomic<std::uint64_t> copied_frames_{0};
    int waiting_ = 0;  // viewers, since newest_ was copied
    bool closed_ = false;
};

}  // namespace eventide
