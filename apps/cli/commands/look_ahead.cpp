// Through openings of its own, and no further than it takes.
#include "apps/cli/commands/look_ahead.h"

#include "drivers/devices.h"
#include "drivers/simulated/simulated_name.h"
#include "replay/formats.h"
#include "src/core/error.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <system_error>

namespace eventide::app {

namespace {

/// Reads on, from `from` where given, until `enough` says so of what was read; false at the end.
bool read_until(const RunSettings& settings, std::optional<SensorTime> from,
                const std::function<bool(const Batch&)>& enough) {
    const auto recording = open_recording(settings.source, settings.input.options());
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

SensorTime first_event(const RunSettings& settings) {
    return TimePointReader{settings.source, settings.input.options()}.time_of({});
}

void check_from(const RunSettings& settings, SensorTime from) {
    SensorTime last = SensorTime::min();
    const auto reaches_it = [&](const Batch& batch) {
        if (!batch.events.empty()) last = batch.events.back().t;
        return last >= from;
    };
    if (read_until(settings, from, reaches_it)) return;
    // A recording with an index may have gone past every event: from the start for the last.
    if (last == SensorTime::min() && read_until(settings, {}, reaches_it)) return;
    const SensorTime first = first_event(settings);
    throw Error(ErrorKind::usage, "--from " + show_time_point(*settings.from) +
                                      ": expected a time until the last event, " +
                                      seconds(last - first) + " or @" +
                                      std::to_string(to_us(last)) + ", of " + settings.source);
}

void check_end(const RunSettings& settings, SensorTime end) {
    const SensorTime first = first_event(settings);
    if (first <= end) return;
    throw Error(ErrorKind::usage, "--to: expected a time after the first event, 0s or @" +
                                      std::to_string(to_us(first)) + ", of " + settings.source);
}

/// A pipe is gone when it has been read.
bool can_be_read_twice(const std::string& source) {
    std::error_code none;
    return !names_camera(source) && !names_simulation(source) && source != "-" &&
           !std::filesystem::is_other(source, none);
}

}  // namespace

void check_recording(const RunSettings& settings, const Span& span, const SlicerSettings& slicer) {
    if (!can_be_read_twice(settings.source)) return;
    if (span.frames_from) check_from(settings, *span.frames_from);
    if (span.end && !span.frames_from) check_end(settings, *span.end);
    const auto has_image = [](const Batch& batch) { return !batch.images.empty(); };
    if (slicer.rule == WindowRule::reference && !read_until(settings, {}, has_image))
        throw Error(ErrorKind::usage, "--window aps: expected reference images in " +
                                          settings.source +
                                          ", found none; another --window, such as 50ms, needs "
                                          "events alone");
}

}  // namespace eventide::app
