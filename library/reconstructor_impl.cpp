// The network at work.
#include "library/reconstructor_impl.h"

#include "library/network_options.h"
#include "src/binning/grid_sums.h"
#include "src/core/error.h"
#include "src/core/frame_stamp.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <new>
#include <string>
#include <utility>

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

Reconstructor::Impl::Impl(const Model& model, int width, int height,
                          const ReconstructorOptions& options)
    : options_(options),
      engine_(engine_of(options)),
      intake_(slicer_of(options, model.config), width, height,
              filter_of(options, model.config, width, height), counters_),
      binner_(model.config.bins, height, width),
      encoder_(model, width, height, engine_),
      renderer_(model, width, height, engine_),
      grid_(binner_.make_output()),
      latent_(encoder_.make_output()),
      schedule_(rate_of(options)) {
    request_.lookahead = options.lookahead;
    request_.want_sigma = options.sigma;
    if (options.images) {
        fused_.emplace(renderer_, width, height, options.lookahead);
        fused_->keep_at_most(FusedRenderer::kMaxWaitingOfRecording);
        latent_.events_per_pixel = Array2<float>(height, width);
        intake_.hold_images();
    }
    Frame frame;
    make_room(options.size, frame);
}

// ---- events to memory ------------------------------------------------------------------------

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
    if (!has_images_) return;
    count_events(grid_, latent_.events_per_pixel);
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
    }
}

void Reconstructor::Impl::forget_stream() {
    renderer_.reset();
    if (fused_) fused_->reset();
    seen_.fill({});
    encoded_ = opened_ = 0;
    silence_ = {};
    has_images_ = new_clock_ = ended_ = false;
}

// ---- memory to frames ------------------------------------------------------------------------

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
    silence_.open(open_.events, schedule_.due());
}

void Reconstructor::Impl::check_silence() {
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
    if (is_finite(frame.intensity) && is_finite(frame.sigma)) return;
    throw Error(ErrorKind::input,
                "frame at " + us(t) +
                    ": expected finite numbers of the network, found NaN or infinity: its weights "
                    "or its state are damaged");
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

// ---- beginnings ------------------------------------------------------------------------------

void Reconstructor::Impl::forget_events() {
    intake_.reset();
    binner_.reset();
    forget_stream();
    gaps_ = {};
    follows_ = false;
    schedule_ = FrameSchedule{rate_of(options_)};
}

void Reconstructor::Impl::reset() {
    forget_events();
    encoder_.reset();
}

void Reconstructor::Impl::restore(const TensorFile& state, const std::string& name) {
    encoder_.restore(state, name);
    forget_events();
}

}  // namespace eventide
