// Events behind the filters, to a file, a pipe or another machine.
#include "apps/cli/run/events_out.h"

#include "apps/cli/commands/recording_out.h"
#include "apps/cli/terminal.h"
#include "replay/udp_target.h"
#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace eventide::app {

namespace {

/// "aedat4" of "aedat4:x"; null where nothing of the kind stands in front, or udp. Throws Error
/// (usage) for a word that is no format that can be written: what a file is called may begin with
/// ./.
const Format* format_in_front(const std::string& to) {
    const std::size_t colon = to.find(':');
    if (to.starts_with("udp:")) return nullptr;
    if (colon == to.npos || to.find_first_of("./") < colon) return nullptr;
    const std::string word = to.substr(0, colon);
    const Format* const format = find_format(word);
    if (format != nullptr && format->is_written()) return format;
    throw Error(ErrorKind::usage,
                to + ": expected " + names_of_writable() + " before the colon, found " + word);
}

}  // namespace

std::string file_of_event_target(const std::string& to) {
    return format_in_front(to) != nullptr ? to.substr(to.find(':') + 1) : to;
}

std::unique_ptr<ConvertTarget> open_event_target(const std::string& to,
                                                 const OutputOptions& options,
                                                 const StreamHeader& header) {
    if (to.starts_with("udp:")) return std::make_unique<UdpTarget>(to, header);
    const std::string file = file_of_event_target(to);
    const Format* format = format_in_front(to);
    if (format == nullptr && file == "-") format = find_format("text");
    if (format == nullptr && !names_folder(file)) {
        format = format_for_writing(file);
        if (format == nullptr)
            throw Error(ErrorKind::usage,
                        to + ": expected the extension of a format that can be written (.aedat4, "
                             ".h5, .raw, .txt, ...), FORMAT:PATH or folder/");
    }
    return std::make_unique<RecordingOut>(file, options, format, header);
}

std::string lost_datagrams(std::uint64_t lost) {
    return counted(lost, "datagram") + " that nobody received";
}

void EventsOut::see(const Batch& batch) {
    BatchPart rest{batch.events, batch.images, batch.imu, batch.triggers};
    keep(take_clock(rest), batch_);
    while (!rest.events.empty()) keep(take_clock(rest), next_clocks_.emplace_back());
    // process() is called with events alone; the rest does not wait for them.
    std::vector<Event> none;
    if (batch.events.empty()) process(none);
}

/// What the target holds, but events.
void EventsOut::keep(const BatchPart& part, Batch& in) const {
    const FormatHolds& holds = target_->holds();
    const auto append = [](const auto& some, bool held, auto& to) {
        if (held) to.insert(to.end(), some.begin(), some.end());
    };
    append(part.images, holds.images, in.images);
    append(part.imu, holds.imu, in.imu);
    append(part.triggers, holds.triggers, in.triggers);
}

/// What was seen of the clocks that begin among these events.
void EventsOut::begin_clocks(std::span<const Event> events) {
    SensorTime last = newest_;
    for (const Event& event : events) {
        if (next_clocks_.empty()) return;
        if (event.t < last) {
            const Batch& of_clock = next_clocks_.front();
            keep({{}, of_clock.images, of_clock.imu, of_clock.triggers}, batch_);
            next_clocks_.pop_front();
        }
        last = event.t;
    }
}

void EventsOut::process(std::vector<Event>& events) {
    begin_clocks(events);
    if (!events.empty()) newest_ = events.back().t;
    if (filter_ != nullptr) filter_->process(events);
    write(events);
}

void EventsOut::release(SensorTime now, std::vector<Event>& events) {
    if (held() == 0) return;
    newest_ = std::max(newest_, now);
    filter_->release(now, events);
    write(events);
}

void EventsOut::flush(std::vector<Event>& events) {
    if (held() == 0) return;
    filter_->flush(events);
    write(events);
}

void EventsOut::write(std::span<const Event> events) {
    batch_.events.assign(events.begin(), events.end());
    if (held() > 0) {
        const SensorTime until = known_until(newest_);
        const auto keep_for_later = [until](auto& all, auto& later) {
            const auto first =
                std::ranges::find_if(all, [&](const auto& i) { return i.t > until; });
            later.assign(std::make_move_iterator(first), std::make_move_iterator(all.end()));
            all.erase(first, all.end());
        };
        keep_for_later(batch_.images, later_.images);
        keep_for_later(batch_.imu, later_.imu);
        keep_for_later(batch_.triggers, later_.triggers);
    }
    const std::optional<SensorTime> from = from_(), to = to_();
    const auto outside = [&](const auto& item) {
        return (from && item.t < *from) || (to && item.t > *to);
    };
    std::erase_if(batch_.events, outside);
    std::erase_if(batch_.images, outside);
    std::erase_if(batch_.imu, outside);
    // A reset divides what was written from what comes, whatever the new clock shows.
    std::erase_if(batch_.triggers, [&](const Trigger& trigger) {
        const bool divides = has_events_ && trigger.kind == Trigger::Kind::timestamp_reset;
        return outside(trigger) && !divides;
    });
    has_events_ |= !batch_.events.empty();
    data_.fit(batch_);
    if (!batch_.empty()) target_->write(batch_);
    batch_.clear();
    std::swap(batch_, later_);
}

void EventsOut::finish() {
    std::vector<Event> rest;  // of a run that failed
    if (held() > 0) filter_->flush(rest);
    write(rest);
    target_->finish();
}

}  // namespace eventide::app
