// packets -> event windows.
#include "pipeline/event_windows.h"

#include "src/binning/push_filtered.h"
#include "src/core/error.h"

#include <algorithm>
#include <new>
#include <utility>

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
    if (packet.gap_before) {
        counters_.bin.gaps.add();
        slicer_.mark_gap();
    }
    parse_packet(packet, live_, *parser_, batch_);
    if (packet.bytes.empty()) {
        advance_in_silence(packet.arrived);
        return;
    }
    last_data_ = packet.arrived;
    counters_.bin.bytes.add(packet.bytes.size());
    look_behind(packet.arrived);
    limit_leap(packet.arrived);
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
    if (filter_ != nullptr) {
        counters_.bin.filtered_events.add(
            flush_filtered(slicer_, *filter_, released_, last_data_.value_or(HostTime{})));
        counters_.note(filter_->flicker());
    }
    // A stream without any event has no frames, even though its clock ran; and images that have
    // another clock do not tell how long it went on in silence.
    const bool one_clock = image_clock_.apart() == SensorDuration{0};
    if (const auto clock = parser_->clock(); clock && slicer_.has_begun() && one_clock)
        slicer_.advance(*clock, last_data_.value_or(HostTime{}));
    slicer_.finish();
    counters_.note(parser_->damaged(), slicer_.counters());
}

void EventWindows::pass_on(HostTime arrived) {
    pieces_.put(batch_);
    while (pieces_.next(piece_)) pass_on_piece(arrived);
}

void EventWindows::pass_on_piece(HostTime arrived) {
    counters_.bin.events.add(piece_.events.size());
    counters_.bin.images.add(piece_.images.size());
    counters_.bin.imu.add(piece_.imu.size());
    counters_.bin.triggers.add(piece_.triggers.size());
    image_clock_.see(piece_);
    counters_.bin.images_apart_us.set(std::uint64_t(image_clock_.apart().count()));
    if (observer_) observer_->see(piece_);
    images_since_.insert(images_since_.end(), piece_.images.size(), slicer_.heard());
    for (const ReferenceImage& image : piece_.images) slicer_.push_reference(image.t);
    if (resumed_at_) leave_out_known();
    while (!stops_.empty() && !piece_.events.empty() && piece_.events.back().t > stops_.back())
        stop(arrived);
    push(piece_.events, arrived);
}

bool EventWindows::next(EventWindow& event_window) {
    if (!slicer_.next(event_window)) return false;
    for (; !images_since_.empty() && !slicer_.ended_before(images_since_.front()); ++images_)
        images_since_.pop_front();
    return true;
}

/// A source that was asked to go to a time may begin before it.
void EventWindows::leave_out_known() {
    const auto known = [this](const Event& event) { return event.t <= *resumed_at_; };
    const auto first = std::ranges::find_if_not(piece_.events, known);
    if (first != piece_.events.end()) resumed_at_.reset();
    piece_.events.erase(piece_.events.begin(), first);
}

void EventWindows::stop(HostTime arrived) {
    const SensorTime t = stops_.back();
    stops_.pop_back();
    const auto first =
        std::ranges::find_if(piece_.events, [t](const Event& event) { return event.t > t; });
    part_.assign(piece_.events.begin(), first);
    piece_.events.erase(piece_.events.begin(), first);
    push(part_, arrived);
    if (!is_past_end()) at_stop_(t);
}

void EventWindows::push(std::vector<Event>& events, HostTime arrived) {
    if (filter_ == nullptr) return slicer_.push(events, arrived);
    counters_.bin.filtered_events.add(push_filtered(slicer_, events, *filter_, arrived));
    counters_.note(filter_->flicker());
}

void EventWindows::stop_at(std::vector<SensorTime> times, std::function<void(SensorTime)> at) {
    stops_ = std::move(times);
    std::ranges::reverse(stops_);
    at_stop_ = std::move(at);
}

void EventWindows::resume(SensorTime t, const Slicer::State& state) {
    slicer_.restore(state);
    resumed_at_ = t;
}

void EventWindows::advance_clock(HostTime arrived) {
    const auto clock = parser_->clock();
    if (!clock || clock == clock_) return;
    clock_ = clock;
    clock_arrived_ = arrived;
    advance(*clock, arrived);
}

void EventWindows::advance(SensorTime now, HostTime arrived) {
    if (filter_ == nullptr) return slicer_.advance(now, arrived);
    counters_.bin.filtered_events.add(advance_filtered(slicer_, now, *filter_, released_, arrived));
}

void EventWindows::advance_in_silence(HostTime now) {
    if (!live_ || !clock_) return;
    const auto silent = std::chrono::duration_cast<SensorDuration>(now - clock_arrived_);
    if (silent <= silence_margin_) return;
    advance(*clock_ + silent - silence_margin_, now);
}

/// A sender whose clock was set begins a new stream, too: nobody wants the frames of the years
/// between. What it sent faster than it was taken, or after a silence, is no leap.
void EventWindows::limit_leap(HostTime arrived) {
    if (!live_ || batch_.events.empty()) return;
    constexpr int kTimesAsFast = 100;
    const HostTime::duration passed = last_events_ ? arrived - *last_events_ : HostTime::duration{};
    last_events_ = arrived;
    slicer_.limit_leap(kMostAhead +
                       kTimesAsFast * std::chrono::duration_cast<SensorDuration>(passed));
}

void EventWindows::look_behind(HostTime arrived) {
    const auto clock = parser_->clock();
    if (live_ && clock) slicer_.look_behind(*clock, arrived);
}

}  // namespace eventide
