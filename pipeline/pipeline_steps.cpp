// What each of the pipeline's threads does with one item; a sequential run does the same in turn.
#include "pipeline/pipeline.h"
#include "src/binning/grid_sums.h"
#include "src/core/error.h"

#include <chrono>
#include <string>
#include <utility>

namespace eventide {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

bool Pipeline::read_one(RawPacket& into) {
    into.gap_before = into.reopened = false;
    const ReadStatus status = parts_.source.read(into);
    if (status == ReadStatus::end) return false;
    if (status == ReadStatus::timeout) {  // an empty packet: only host time passes
        into.bytes.clear();
        into.arrived = Clock::now();
        return true;
    }
    counters_.read.packets.add();
    counters_.read.bytes.add(into.bytes.size());
    into.sequence = counters_.read.packets.value();
    return true;
}

/// A recording waits for a buffer; empty where a live source must not.
Pool<RawPacket>::Handle Pipeline::packet_to_fill() {
    if (!parts_.source.is_live()) return packet_pool_.acquire();
    return keeper_.takes_packet(packets_.waiting()) ? packet_pool_.try_acquire()
                                                    : Pool<RawPacket>::Handle{};
}

void Pipeline::hand_on(const CutWindow& event_window) {
    auto grid = grid_pool_.acquire();
    bin_one(event_window, *grid);
    grids_.push(std::move(grid));
}

EventWindows::End Pipeline::ending() const {
    return stop_.is_set() ? EventWindows::End::asked_for : EventWindows::End::of_source;
}

void Pipeline::cut(const RawPacket& packet) {
    if (settings_.changes != nullptr)
        if (const auto window = settings_.changes->take_window())
            event_windows_.change_window(*window);
    event_windows_.take(packet);
}

void Pipeline::keep_state(SensorTime t) {
    const auto slicer = event_windows_.state();
    if (!slicer)
        throw Error(ErrorKind::input, "the state at " + std::to_string(to_us(t)) +
                                          " us: expected events before, windows that images do "
                                          "not cut, and a clock that did not begin anew");
    settings_.state_stops.keep({t, *slicer, binner_.ages()});
}

void Pipeline::bin_one(const CutWindow& event_window, VoxelGrid& grid) {
    const HostTime begun = Clock::now();
    if (event_window.reset_before || (event_window.gap_before && settings_.reset_on_gap))
        binner_.reset();
    binner_.process(event_window, grid);
    grid.images = event_window.images;
    if (counters_.bin.event_windows.value() == 0)
        counters_.bin.begin_us.set(std::uint64_t(to_us(event_window.window.begin)));
    counters_.bin.event_windows.add();
    counters_.bin.silent_windows.add(event_window.events.empty() ? 1 : 0);
    counters_.bin.window_events.add(event_window.events.size());
    counters_.bin.window_begin_us.set(std::uint64_t(to_us(event_window.window.begin)));
    counters_.bin.window_end_us.set(std::uint64_t(to_us(event_window.window.end)));
    counters_.bin.work.record(Clock::now() - begun);
}

void Pipeline::encode_one(const VoxelGrid& grid, Encoded& encoded) {
    const HostTime begun = Clock::now();
    if (grid.reset_before || (grid.gap_before && settings_.reset_on_gap)) {
        parts_.encoder.reset();
        counters_.encode.state_resets.add();
    }
    LatentMap& latent = encoded.latent;
    parts_.encoder.encode(grid, latent);
    // Who asks for them corrects frames by images, and by none before the first.
    if (settings_.events_per_pixel && grid.images > 0) count_events(grid, latent.events_per_pixel);
    if (settings_.event_preview) sum_polarities(grid, encoded.event_preview);
    counters_.encode.encoded.add();
    const HostTime::duration work = Clock::now() - begun;
    counters_.encode.work.record(work);
    keeper_.window_took(work);
}

void Pipeline::present_one(Encoded& encoded) {
    if (!output_.take(encoded)) stop();
}

Encoded Pipeline::make_encoded() const {
    Encoded encoded;
    encoded.latent = parts_.encoder.make_output();
    const SensorInfo& info = parts_.source.info();
    if (settings_.event_preview) encoded.event_preview = Array2<float>(info.height, info.width);
    if (settings_.events_per_pixel)
        encoded.latent.events_per_pixel = Array2<float>(info.height, info.width);
    return encoded;
}

}  // namespace eventide
