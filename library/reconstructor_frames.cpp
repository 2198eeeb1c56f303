// The network at work: memory to frames.
#include "library/network_options.h"
#include "library/reconstructor_impl.h"
#include "src/core/error.h"
#include "src/core/finite_frame.h"
#include "src/core/frame_stamp.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <cstdint>
#include <new>
#include <string>

namespace eventide {
namespace {

bool same(const FrameSize& a, const FrameSize& b) {
    return a.width == b.width && a.height == b.height && a.region.x == b.region.x &&
           a.region.y == b.region.y && a.region.width == b.region.width &&
           a.region.height == b.region.height;
}

std::string us(SensorTime t) {
    return std::to_string(to_us(t)) + " us";
}

}  // namespace

bool Reconstructor::Impl::next(Frame& frame) {
    for (;;) {
        if (schedule_.due() > 0) {
            render_due(frame);
            return true;
        }
        const std::uint64_t waits = ended_ ? 0 : std::uint64_t(options_.lookahead);
        if (encoded_ - opened_ > waits) {
            open_next();
            check_silence();
        } else if (!step()) {
            return false;
        }
    }
}

void Reconstructor::Impl::open_next() {
    open_ = seen(opened_++);
    schedule_.open(open_.window);
    open_.gap_before = gaps_.open(open_.gap_before);
}

void Reconstructor::Impl::check_silence() {
    silence_.open(open_.events, schedule_.due());
    if (!silence_.is_exceeded() || options_.allow_silence) return;
    schedule_.skip(schedule_.due());
    silence_.refuse(open_.window);
}

void Reconstructor::Impl::render_due(Frame& frame) {
    follows_ = true;
    const DueFrame due = schedule_.next();
    // The stream's first frame may stand at the first window's begin, which is outside it.
    render_request(std::max(due.t, open_.window.begin + SensorDuration{1}), options_.size, frame);
    stamp_frame(due.t, due.index, open_, frame);
    gaps_.tell();
}

Readiness Reconstructor::Impl::readiness(SensorTime t) {
    for (;;) {
        const Readiness found = renderer_.readiness(t, options_.lookahead);
        const bool of_next_stream = found == Readiness::gone && new_clock_;
        if (found != Readiness::later && !of_next_stream) return found;
        if (!keeps_frames() || !step()) return found;
    }
}

void Reconstructor::Impl::render(SensorTime t, const FrameSize& size, Frame& frame) {
    const Readiness found = readiness(t);
    if (found != Readiness::ready)
        throw Error(ErrorKind::usage,
                    "frame at " + us(t) + ": expected a time that is ready, found one " +
                        (found == Readiness::later
                             ? keeps_frames() ? "that waits for events not pushed yet"
                                              : "that waits until next() has given those before"
                             : "outside the event windows that the network remembers"));
    render_request(t, size, frame);
}

void Reconstructor::Impl::render_request(SensorTime t, const FrameSize& size, Frame& frame) {
    try {
        make_room(size, frame);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorKind::failed,
                    "frame of " +
                        size_text(size.width != 0 ? size.width : encoder_.width(),
                                  size.height != 0 ? size.height : encoder_.height()) +
                        ": expected enough memory for it, found too little");
    }
    request_.t = t;
    if (fused_) {
        fused_->render(request_, frame);
        note_images();
    } else {
        renderer_.render(request_, frame);
    }
    ++counters_.frames;
    if (!is_finite(frame)) refuse_not_finite("frame at " + us(t));
}

/// Rendering cannot fail afterwards.
void Reconstructor::Impl::make_room(const FrameSize& size, Frame& frame) {
    check_frame_size(size, encoder_.width(), encoder_.height());
    RenderRequest request = request_;
    request.width = size.width;
    request.height = size.height;
    request.region = size.region;
    renderer_.make_room(request, frame);
    if (!room_for_ || !same(size, *room_for_)) {
        room_for_.reset();
        if (fused_) fused_->prepare(request);
    }
    request_ = request;
    room_for_ = size;
}

std::optional<SensorTime> Reconstructor::Impl::newest() {
    while (keeps_frames() && step()) {
    }
    const std::uint64_t waits = ended_ ? 0 : std::uint64_t(options_.lookahead);
    if (encoded_ <= waits) return std::nullopt;
    return seen(encoded_ - 1 - waits).window.end;
}

}  // namespace eventide
