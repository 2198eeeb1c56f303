#include "pipeline/sinks/http/newest_frame.h"

#include <utility>

namespace eventide {

void NewestFrame::offer(const Frame& frame) {
    {
        const std::lock_guard lock{mutex_};
        held_ = false;
        if (waiting_ == 0 || closed_) return;
    }
    publish(frame);
}

Frame NewestFrame::Spare::take() {
    const std::lock_guard lock{mutex};
    if (frames.empty()) return {};
    Frame frame = std::move(frames.back());
    frames.pop_back();
    return frame;
}

void NewestFrame::Spare::give_back(Frame frame) {
    const std::lock_guard lock{mutex};
    if (frames.size() < kMax) frames.push_back(std::move(frame));
}

std::shared_ptr<const ShownFrame> NewestFrame::copy_of(const Frame& frame, Clock::time_point now) {
    Frame copy = spare_->take();
    copy = frame;  // into the memory that is there, where the size is the same
    auto shown = std::make_unique<ShownFrame>(std::move(copy), sigma_white_, now - frame.arrived);
    return {shown.release(), [spare = spare_](ShownFrame* seen) {
                spare->give_back(seen->take_frame());
                delete seen;
            }};
}

/// Copied without the lock: viewers may look at the clock meanwhile.
void NewestFrame::publish(const Frame& frame) {
    const Clock::time_point now = Clock::now();
    std::shared_ptr<const ShownFrame> shown = copy_of(frame, now);
    ++copied_frames_;
    {
        const std::lock_guard lock{mutex_};
        std::swap(newest_, shown);
        copied_ = now;
        waiting_ = 0;
    }
    came_.notify_all();
}

void NewestFrame::offer_while_held(const Frame& frame, std::chrono::milliseconds most) {
    {
        std::unique_lock lock{mutex_};
        if (!wanted_.wait_for(lock, most, [&] { return closed_ || (waiting_ > 0 && !held_); }))
            return;
        if (closed_) return;
    }
    publish(frame);
    const std::lock_guard lock{mutex_};
    held_ = true;
}

std::shared_ptr<const ShownFrame> NewestFrame::next(const std::shared_ptr<const ShownFrame>& seen,
                                                    Clock::time_point until) {
    std::unique_lock lock{mutex_};
    if (closed_) return nullptr;
    if (newest_ && newest_ != seen && (held_ || Clock::now() - copied_ <= kFresh)) return newest_;
    const std::shared_ptr<const ShownFrame> before = newest_;
    ++waiting_;
    wanted_.notify_one();
    if (!came_.wait_until(lock, until, [&] { return closed_ || newest_ != before; })) {
        if (waiting_ > 0) --waiting_;
        return nullptr;
    }
    return closed_ ? nullptr : newest_;
}

bool NewestFrame::sleep(Clock::time_point until) {
    std::unique_lock lock{mutex_};
    return !came_.wait_until(lock, until, [&] { return closed_; });
}

void NewestFrame::close() {
    {
        const std::lock_guard lock{mutex_};
        closed_ = true;
    }
    came_.notify_all();
    wanted_.notify_all();
}

bool NewestFrame::is_closed() const {
    const std::lock_guard lock{mutex_};
    return closed_;
}

}  // namespace eventide
