// Through openings of its own, and no further than it takes.
#include "apps/cli/commands/look_ahead.h"

#include "drivers/devices.h"
#include "drivers/simulated/simulated_name.h"
#include "replay/formats.h"
#include "src/core/error.h"
#include "src/settings/values.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <system_error>

namespace eventide::app {

namespace {

/// Reads on, from `from` where given, until `enough` says so of what was read; false at the end.
bool read_until(const AskedPart& part, std::optional<SensorTime> from,
                const std::function<bool(const Batch&)>& enough) {
    const auto recording = open_recording(part.source, part.options);
    if (from) recording->seek(*from);
    const auto parser = recording->make_parser();
    RawPacket packet;
    Batch batch;
    while (recording->read(packet) == ReadStatus::data) {
        parser->parse(packet.bytes, batch);
        if (enough(batch)) return true;
        batch.clear();
    }
    parser->finish(batch);
    return enough(batch);
}

std::string seconds(SensorDuration duration) {
    return show_number(double(duration.count()) / 1e6) + "s";
}

SensorTime first_event(const AskedPart& part) {
    return TimePointReader{part.source, part.options}.time_of({});
}

void check_from(const AskedPart& part) {
    SensorTime last = SensorTime::min();
    const auto reaches_it = [&](const Batch& batch) {
        // Of a clock that began anew, later events may have earlier times.
        for (const Event& event : batch.events) last = std::max(last, event.t);
        return last >= *part.from;
    };
    if (read_until(part, part.from, reaches_it)) return;
    // A recording with an index may have gone past every event: from the start for the last.
    if (last == SensorTime::min() && read_until(part, {}, reaches_it)) return;
    const SensorTime first = first_event(part);
    throw Error(ErrorKind::usage,
                "--from " + show_time_point(part.from_said.value_or(TimePoint{})) +
                    ": expected a time until the last event, " + seconds(last - first) + " or @" +
                    std::to_string(to_us(last)) + ", of " + part.source);
}

void check_end(const AskedPart& part) {
    const SensorTime first = first_event(part);
    if (first <= *part.to) return;
    throw Error(ErrorKind::usage, "--to: expected a time after the first event, 0s or @" +
                                      std::to_string(to_us(first)) + ", of " + part.source +
                                      ", found an end before it");
}

bool can_be_read_twice(const std::string& source) {
    return !names_camera(source) && !names_simulation(source) && !is_read_once(source);
}

}  // namespace

void check_order(std::optional<SensorTime> from, std::optional<SensorTime> to) {
    if (from && to && *to < *from)
        throw Error(ErrorKind::usage, "--to lies before --from, by " + show_duration(*from - *to));
}

void check_part(const AskedPart& part) {
    check_order(part.from, part.to);
    if (!can_be_read_twice(part.source)) return;
    if (part.from) check_from(part);
    if (part.to) check_end(part);
}

void check_images(const AskedPart& part, const SlicerSettings& slicer) {
    if (slicer.rule != WindowRule::reference || !can_be_read_twice(part.source)) return;
    const auto has_image = [](const Batch& batch) { return !batch.images.empty(); };
    if (!read_until(part, {}, has_image))
        throw Error(ErrorKind::usage, "--window aps: expected reference images in " + part.source +
                                          ", found none; another --window, such as 50ms, needs "
                                          "events alone");
}

}  // namespace eventide::app
