// latent maps -> frames -> sinks.
#include "pipeline/frame_output.h"

#include "pipeline/first_error.h"
#include "src/core/error.h"
#include "src/core/finite_frame.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <string>
#include <utility>

namespace eventide {

using Clock = std::chrono::steady_clock;

FrameOutput::FrameOutput(RenderStage& renderer, std::vector<Sink*> sinks, const Settings& settings,
                         std::function<std::size_t()> waiting, const StopRequest& stop,
                         Counters& counters, LatencyKeeper& keeper)
    : renderer_(renderer),
      sinks_(std::move(sinks)),
      settings_(settings),
      waiting_(std::move(waiting)),
      stop_(stop),
      counters_(counters),
      keeper_(keeper),
      lookahead_(settings.lookahead),
      halvings_(settings.halvings),
      schedule_(settings.rate, settings.from),
      dropper_(settings.waits_at_most),
      frame_(renderer.make_output()) {
    if (settings.lookahead < 0 || settings.lookahead > kMaxLookahead)
        throw Error(ErrorKind::usage,
                    "lookahead: expected 0, 1 or 2, found " + std::to_string(settings.lookahead));
}

void FrameOutput::accept(Encoded& encoded) {
    const LatentMap& latent = encoded.latent;
    if (latent.reset_before) {
        finish();
        renderer_.reset();
        schedule_.restart();
    }
    if (settings_.changes != nullptr) change();
    const HostTime begun = Clock::now();
    renderer_.take(encoded.latent);
    counters_.present.take.record(Clock::now() - begun);
    arrived_ = latent.arrived;
    Waiting& held = held_[(oldest_ + held_count_++) % held_.size()];
    copy_stamp(latent, held);
    held.event_preview = encoded.event_preview;
}

bool FrameOutput::present() {
    while (held_count_ > std::size_t(lookahead_)) present_oldest();
    return wanted_;
}

/// All frames that were due are done. A size that is impossible leaves the old one: who asked sees
/// it in the frames.
void FrameOutput::change() {
    const LiveChanges::Wanted wanted = settings_.changes->take();
    if (wanted.rate) schedule_.change_rate(*wanted.rate);
    if (wanted.halvings) halvings_ = *wanted.halvings;
    if (wanted.lookahead && *wanted.lookahead >= 0 && *wanted.lookahead <= kMaxLookahead &&
        renderer_.change_lookahead(*wanted.lookahead))
        lookahead_ = *wanted.lookahead;
    if (!wanted.size) return;
    try {
        renderer_.change_size(wanted.size->width, wanted.size->height, frame_);
    } catch (const Error&) {
    } catch (const std::bad_alloc&) {
    }
}

bool FrameOutput::finish() {
    renderer_.finish();
    while (held_count_ > 0) present_oldest();
    return wanted_;
}

void FrameOutput::present_oldest() {
    Waiting& held = held_[oldest_];
    oldest_ = (oldest_ + 1) % held_.size();
    --held_count_;
    tell_lookahead();
    schedule_.open(held.window);
    held.gap_before = gaps_.open(held.gap_before);
    check_silence(held);
    if (settings_.live) open_dropper();
    while (schedule_.due() > 0 && wanted_ && !stop_.is_overdue()) {
        const DueFrame due = schedule_.next();
        const bool is_shown = is_watched() && (settings_.live ? dropper_.keeps_next(waiting_())
                                                              : is_kept(due.index, halvings_));
        if (!is_shown) {
            counters_.present.skipped_frames.add();
            continue;
        }
        const HostTime::duration work = present(due, held);
        if (!settings_.live) continue;
        dropper_.took(work);
        keeper_.frame_took(work);
    }
}

/// What came behind the window at hand: less than the lookahead at the end, more where that has
/// just become shorter.
void FrameOutput::tell_lookahead() {
    if (told_lookahead_ == held_count_) return;
    told_lookahead_ = held_count_;
    for (Sink* sink : sinks_) sink->lookahead_is(int(held_count_));
}

bool FrameOutput::is_watched() const {
    return sinks_.empty() ||
           std::ranges::any_of(sinks_, [](const Sink* sink) { return sink->is_watched(); });
}

void FrameOutput::open_dropper() {
    const HostTime now = Clock::now();
    dropper_.open({schedule_.next_index(), schedule_.due(), std::max(keeper_.halvings(), halvings_),
                   keeper_.frames_in_time(now - arrived_)},
                  now);
}

/// Before any of the window's frames: a long silence comes as one wide window.
void FrameOutput::check_silence(const Waiting& held) {
    silence_.open(held.events, schedule_.due());
    if (silence_.is_exceeded() && !settings_.live && !settings_.allow_silence)
        silence_.refuse(held.window);
}

/// Returns how long it worked.
HostTime::duration FrameOutput::present(const DueFrame& due, Waiting& from) {
    const HostTime begun = Clock::now();
    renderer_.render(due.t, from.window, frame_);
    stamp_frame(due.t, due.index, from, frame_);
    gaps_.tell();
    frame_.arrived = arrived_;
    std::swap(frame_.event_preview, from.event_preview);
    check_finite();
    const HostTime rendered = Clock::now();
    HostTime::duration held{};
    for (Sink* sink : sinks_) {
        sink->write(frame_);
        held += sink->held();
        wanted_ = wanted_ && sink->wants_more();
    }
    std::swap(frame_.event_preview, from.event_preview);
    const HostTime written = Clock::now() - held;
    counters_.present.frames.add();
    counters_.present.newest_us.set(std::uint64_t(to_us(due.t)));
    counters_.present.render.record(rendered - begun);
    counters_.present.write.record(written - rendered);
    counters_.present.latency.record(written - arrived_);
    return written - begun;
}

void FrameOutput::check_finite() {
    if (is_finite(frame_) &&
        std::ranges::all_of(frame_.colour, [](const auto& plane) { return is_finite(plane); }))
        return;
    counters_.present.broken_frames.add();
    refuse_not_finite("frame " + std::to_string(frame_.index) + ", at " +
                      std::to_string(to_us(frame_.t)) + " us");
}

void FrameOutput::close() {
    FirstError error;
    for (Sink* sink : sinks_) error.guard([&] { sink->close(); });
    error.rethrow_if_any();
}

}  // namespace eventide
