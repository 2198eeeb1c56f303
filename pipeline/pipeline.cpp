// The pipeline: four functions, each one thread (pipeline_steps.cpp: what each does with one item).
#include "pipeline/pipeline.h"

#include "pipeline/pace/encoder_gate.h"
#include "src/core/error.h"

#include <pthread.h>

#include <string>
#include <utility>

namespace eventide {
namespace {

using Clock = std::chrono::steady_clock;

std::size_t at_least_one(std::size_t n, const char* name) {
    if (n < 1)
        throw Error(ErrorKind::usage, std::string{"buffers: "} + name + " must be at least 1");
    return n;
}

FrameOutput::Settings output_settings(const PipelineParts& parts,
                                      const PipelineSettings& settings) {
    FrameOutput::Settings s;
    s.rate = settings.rate;
    s.from = settings.frames_from;
    s.lookahead = settings.lookahead;
    s.live = parts.source.is_live();
    s.allow_silence = settings.allow_silence;
    s.changes = settings.changes;
    s.halvings = settings.halvings;
    // One buffer is being filled; were all the others waiting, the encoder would wait, too, and in
    // the end the camera would lose events.
    s.waits_at_most = settings.buffers.latents - 1;
    return s;
}

}  // namespace

Pipeline::Pipeline(const PipelineParts& parts, const PipelineSettings& settings)
    : parts_(parts),
      settings_(settings),
      keeper_(parts.source.is_live() ? settings.latency : std::nullopt),
      event_windows_(parts.source, settings.event_windows, parts.filter, parts.observer, counters_),
      binner_(settings.bins, parts.source.info().height, parts.source.info().width),
      packet_pool_(at_least_one(settings.buffers.packets, "packets"), [] { return RawPacket{}; }),
      grid_pool_(at_least_one(settings.buffers.grids, "grids"),
                 [this] { return binner_.make_output(); }),
      latent_pool_(at_least_one(settings.buffers.latents, "latents"),
                   [this] { return make_encoded(); }),
      packets_(settings.buffers.packets),
      grids_(settings.buffers.grids),
      latents_(settings.buffers.latents),
      output_(
          parts.renderer, parts.sinks, output_settings(parts, settings),
          [this] { return latents_.waiting(); }, stop_, counters_, keeper_) {
    if (settings.resume == nullptr) return;
    event_windows_.resume(settings.resume->t, settings.resume->slicer);
    binner_.restore(settings.resume->ages);
}

// ---- the pipeline ----------------------------------------------------------------------------

void Pipeline::read() {  // bytes
    bool gap = false, reopened = false;
    guarded([&] {
        for (;;) {
            auto packet = packet_to_fill();
            if (!read_one(packet ? *packet : spill_)) break;
            if (!packet && (packet = packet_to_fill())) std::swap(*packet, spill_);
            if (!packet) {  // the one place where data are lost
                counters_.read.lost_packets.add(spill_.bytes.empty() ? 0 : 1);
                counters_.read.lost_bytes.add(spill_.bytes.size());
                gap = gap || spill_.gap_before || !spill_.bytes.empty();
                reopened = reopened || spill_.reopened;
                continue;
            }
            packet->gap_before |= std::exchange(gap, false);
            packet->reopened |= std::exchange(reopened, false);
            packets_.push(std::move(packet));
        }
    });
    packets_.close();
}

void Pipeline::bin() {  // bytes -> events -> grids
    EncoderGate gate{
        keeper_,
        {grid_pool_.size(), settings_.event_windows.slicer.max_events, settings_.reset_on_gap},
        [this] { return grid_pool_.lent(); },
        [this](const CutWindow& event_window) { hand_on(event_window); }};
    const auto take = [&](const CutWindow& event_window) { gate.take(event_window); };
    const bool complete = for_each(packets_, [&](const RawPacket& packet) {
        const HostTime begun = Clock::now();
        cut(packet);
        for_each_event_window(take);
        gate.look_again();
        counters_.bin.merged_windows.set(gate.merged());
        if (!packet.bytes.empty()) keeper_.packet_took(Clock::now() - begun);
    });
    if (complete)
        guarded([&] {
            event_windows_.finish(ending());
            for_each_event_window(take);
            gate.flush();
            counters_.bin.merged_windows.set(gate.merged());
        });
    grids_.close();
}

void Pipeline::encode() {  // grids -> latent maps
    for_each(grids_, [&](const VoxelGrid& grid) {
        auto encoded = latent_pool_.acquire();
        encode_one(grid, *encoded);
        latents_.push(std::move(encoded));
    });
    latents_.close();
}

void Pipeline::present() {  // latent maps -> frames -> sinks
    const bool complete = guarded([&] {
        while (auto encoded = latents_.pop()) {
            output_.accept(**encoded);
            encoded.reset();  // home, before its frames are rendered
            if (!output_.present()) stop();
        }
    });
    while (!complete && latents_.pop()) continue;
    if (complete) guarded([&] { output_.finish(); });
}

// ---- starting, ending, failing ---------------------------------------------------------------

void Pipeline::run() {
    if (!settings_.state_stops.times.empty())
        throw Error(ErrorKind::usage, "states on the way: expected a sequential run");
    {
        std::jthread reading, binning, encoding;
        start(reading, "eventide-read", &Pipeline::read, packets_);
        // A thread that is not there takes nothing: what is meant for it goes home here, so that
        // its sender does not wait for ever.
        if (!start(binning, "eventide-bin", &Pipeline::bin, grids_))
            while (packets_.pop()) continue;
        if (!start(encoding, "eventide-encode", &Pipeline::encode, latents_))
            while (grids_.pop()) continue;
        present();
    }
    close_and_report();
}

void Pipeline::run_sequential() {
    RawPacket packet;
    VoxelGrid grid = binner_.make_output();
    Encoded encoded = make_encoded();
    bool presenting = true;
    const auto hand_on = [&](const CutWindow& event_window) {
        bin_one(event_window, grid);
        encode_one(grid, encoded);
        presenting = presenting && guarded([&] { present_one(encoded); });
    };
    event_windows_.stop_at(settings_.state_stops.times, [&](SensorTime t) {
        for_each_event_window(hand_on);
        keep_state(t);
    });
    const auto reads = [&] {
        bool more = false;
        return guarded([&] { more = read_one(packet); }) && more;
    };
    const bool complete = guarded([&] {
        while (reads()) {
            cut(packet);
            for_each_event_window(hand_on);
        }
    });
    if (complete)
        guarded([&] {
            event_windows_.finish(ending());
            for_each_event_window(hand_on);
        });
    if (presenting) guarded([&] { output_.finish(); });
    close_and_report();
}

void Pipeline::stop() noexcept {
    stop_.set();
    parts_.source.stop();
}

/// A thread that cannot start must still close the link it would have closed.
template <typename Handle>
bool Pipeline::start(std::jthread& thread, const char* name, void (Pipeline::*work)(),
                     Link<Handle>& out) {
    const bool started = guarded([&] {
        thread = std::jthread{[this, name, work] {
            pthread_setname_np(pthread_self(), name);
            (this->*work)();
        }};
    });
    if (!started) out.close();
    return started;
}

template <typename Body>
void Pipeline::for_each_event_window(Body body) {
    for (EventWindow event_window; event_windows_.next(event_window) && !stop_.is_overdue();)
        body(CutWindow{event_window, event_windows_.images()});
    if (event_windows_.is_past_end()) parts_.source.stop();
}

/// Runs `body` on every item. After an error it still empties the link, so that buffers go home and
/// nothing upstream waits for ever.
template <typename Handle, typename Body>
bool Pipeline::for_each(Link<Handle>& link, Body body) {
    const bool complete = guarded([&] {
        while (auto item = link.pop()) body(**item);
    });
    if (!complete)
        while (link.pop()) continue;
    return complete;
}

/// False where it threw: the error is kept and the source asked to stop.
template <typename Body>
bool Pipeline::guarded(Body body) noexcept {
    if (error_.guard(body)) return true;
    parts_.source.stop();
    return false;
}

void Pipeline::close_and_report() {
    guarded([&] { output_.close(); });
    error_.rethrow_if_any();
}

}  // namespace eventide
