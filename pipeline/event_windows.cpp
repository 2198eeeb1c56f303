// packets -> event windows.
#include "pipeline/event_windows.h"

#include "src/core/error.h"

#include <new>

namespace eventide {

EventWindows::EventWindows(const Source& source, const Settings& settings, EventFilter* filter,
                           DataObserver* observer, Counters& counters)
    : parser_(source.make_parser()),
      slicer_(settings.slicer, source.info().width, source.info().height),
      filter_(filter),
      observer_(observer),
      counters_(counters),
      live_(source.is_live()),
      silence_margin_(settings.silence_margin) {}

void EventWindows::take(const RawPacket& packet) {
    if (packet.gap_before) note_gap();
    if (packet.bytes.empty()) {
        advance_in_silence(packet.arrived);
        return;
    }
    last_data_ = packet.arrived;
    counters_.bin.bytes.add(packet.bytes.size());
    if (live_) parser_->arrives(packet.arrived);
    parser_->parse(packet.bytes, batch_);
    pass_on(packet.arrived);
    if (live_) advance_clock(packet.arrived);
    counters_.note(parser_->damaged(), slicer_.counters());
}

/// Who asked sees it in the windows.
void EventWindows::change_window(const SlicerSettings& wanted) noexcept {
    try {
        slicer_.change(wanted);
    } catch (const Error&) {
    } catch (const std::bad_alloc&) {
    }
}

void EventWindows::finish(End end) {
    if (end == End::of_source && !is_past_end()) parser_->finish(batch_);
    pass_on(last_data_.value_or(HostTime{}));
    // A stream without any event has no frames, even though its clock ran.
    if (const auto clock = parser_->clock(); clock && slicer_.has_begun())
        slicer_.advance(*clock, last_data_.value_or(HostTime{}));
    slicer_.finish();
    counters_.note(parser_->damaged(), slicer_.counters());
}

void EventWindows::note_gap() {
    counters_.bin.gaps.add();
    parser_->resync();
    slicer_.mark_gap();
}

void EventWindows::pass_on(HostTime arrived) {
    counters_.bin.events.add(batch_.events.size());
    counters_.bin.images.add(batch_.images.size());
    counters_.bin.imu.add(batch_.imu.size());
    counters_.bin.triggers.add(batch_.triggers.size());
    if (observer_) observer_->see(batch_);
    for (const ReferenceImage& image : batch_.images) slicer_.push_reference(image.t);
    if (filter_ && !batch_.events.empty())
        push_filtered(arrived);
    else
        slicer_.push(batch_.events, arrived);
    batch_.clear();
}

/// Events that are left out tell the time all the same.
void EventWindows::push_filtered(HostTime arrived) {
    const SensorTime newest = batch_.events.back().t;
    const std::size_t before = batch_.events.size();
    filter_->process(batch_.events);
    counters_.bin.filtered_events.add(before - batch_.events.size());
    slicer_.push(batch_.events, arrived);
    slicer_.advance(newest, arrived);
}

void EventWindows::advance_clock(HostTime arrived) {
    const auto clock = parser_->clock();
    if (!clock || clock == clock_) return;
    clock_ = clock;
    clock_arrived_ = arrived;
    slicer_.advance(*clock, arrived);
}

void EventWindows::advance_in_silence(HostTime now) {
    if (!live_ || !clock_) return;
    const auto silent = std::chrono::duration_cast<SensorDuration>(now - clock_arrived_);
    if (silent > silence_margin_) slicer_.advance(*clock_ + silent - silence_margin_, now);
}

}  // namespace eventide
