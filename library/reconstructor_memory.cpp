// The network at work: events to memory.
#include "library/reconstructor_impl.h"
#include "src/binning/grid_sums.h"

#include <cstdint>

namespace eventide {

/// One step of the network, where there is one to make.
bool Reconstructor::Impl::step() {
    if (new_clock_) {  // what came before means nothing any more
        encoder_.reset();
        schedule_.skip(schedule_.due());
        schedule_.restart();
        forget_stream();
        encode();
        return true;
    }
    if (EventWindow event_window; intake_.next(event_window)) {
        bin(event_window);
        if (grid_.reset_before) {
            renderer_.finish();
            new_clock_ = ended_ = true;
        } else {
            encode();
        }
        return true;
    }
    if (!intake_.is_finished() || ended_) return false;
    renderer_.finish();
    ended_ = true;
    return true;
}

/// Event windows that may have been encoded and not opened by next(). The codes of that many are
/// kept. A correction by images follows the newest window that frames may see, and does not go
/// back.
std::uint64_t Reconstructor::Impl::most_waiting() const {
    const bool is_corrected = fused_ && (has_images_ || intake_.has_images());
    return std::uint64_t(is_corrected ? options_.lookahead : FrameOutput::kMaxLookahead);
}

/// Whether a step leaves all frames to next() that it has not given, or nobody calls it.
bool Reconstructor::Impl::keeps_frames() const {
    const std::uint64_t waiting = encoded_ - opened_;
    if (!follows_) return true;
    if (new_clock_) return waiting == 0 && schedule_.due() == 0;
    const std::uint64_t most = most_waiting();
    return waiting < most || (waiting == most && schedule_.due() == 0);
}

void Reconstructor::Impl::bin(const EventWindow& event_window) {
    if (event_window.reset_before || (event_window.gap_before && options_.reset_on_gap))
        binner_.reset();
    binner_.process(event_window, grid_);
}

void Reconstructor::Impl::encode() {
    if (grid_.gap_before && options_.reset_on_gap) encoder_.reset();
    encoder_.encode(grid_, latent_);
    renderer_.take(latent_);
    correct();
    ++counters_.event_windows;
    note_window();
}

/// By the images that the stream had told when the window at hand was cut.
void Reconstructor::Impl::correct() {
    if (!fused_) return;
    has_images_ = fused_->give_all([this] { return intake_.next_image(); }) || has_images_;
    if (has_images_) count_events(grid_, latent_.events_per_pixel);
    // Windows before the first image, too: it is followed from its own time, not from the begin.
    fused_->push(grid_.window, latent_.events_per_pixel);
    note_images();
}

void Reconstructor::Impl::note_images() noexcept {
    counters_.used_images = fused_->used();
    counters_.dropped_images = fused_->dropped();
}

/// Where render() went ahead of next(), the frames of windows that the network cannot show any more
/// as they were are left out: those of the open window first, then those of the oldest that waits.
void Reconstructor::Impl::note_window() {
    copy_stamp(grid_, seen(encoded_++));
    const std::uint64_t most = most_waiting();
    if (encoded_ - opened_ > most) schedule_.skip(schedule_.due());
    while (encoded_ - opened_ > most + 1) {
        open_next();
        schedule_.skip(schedule_.due());
        silence_.open(open_.events, 0);
    }
}

}  // namespace eventide
