// What went through the pipeline, and what did not.
#include "pipeline/counters.h"

namespace eventide {

void Counters::note(const Damage& damaged, const SlicerCounters& slicing) {
    for (std::size_t i = 0; i < kDamageReasons; ++i) bin.damaged[i].set(damaged[DamageReason(i)]);
    bin.before_begin.set(slicing.before_begin);
    bin.after_end.set(slicing.after_end);
    bin.too_many.set(slicing.too_many);
    bin.late.set(slicing.late);
    bin.late_references.set(slicing.late_references);
    bin.time_resets.set(slicing.time_resets);
}

void Counters::note(const FlickerFound& flicker) {
    bin.flicker_millihertz.set(std::uint64_t(1000 * flicker.hz));
    bin.last_flicker_millihertz.set(std::uint64_t(1000 * flicker.last_hz));
    bin.flicker_events.set(flicker.left_out);
}

Snapshot Counters::snapshot() const {
    Snapshot s;
    s.packets = read.packets.value();
    s.bytes = read.bytes.value();
    s.lost_packets = read.lost_packets.value();
    s.lost_bytes = read.lost_bytes.value();

    s.parsed_bytes = bin.bytes.value();
    s.gaps = bin.gaps.value();
    s.events = bin.events.value();
    s.images = bin.images.value();
    s.imu = bin.imu.value();
    s.triggers = bin.triggers.value();
    s.images_apart = SensorDuration{std::int64_t(bin.images_apart_us.value())};
    s.filtered_events = bin.filtered_events.value();
    s.flicker = {double(bin.flicker_millihertz.value()) / 1000,
                 double(bin.last_flicker_millihertz.value()) / 1000, bin.flicker_events.value()};
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        s.damaged.count(DamageReason(i), bin.damaged[i].value());
    s.slicing.before_begin = bin.before_begin.value();
    s.slicing.after_end = bin.after_end.value();
    s.slicing.too_many = bin.too_many.value();
    s.slicing.late = bin.late.value();
    s.slicing.late_references = bin.late_references.value();
    s.slicing.time_resets = bin.time_resets.value();
    s.event_windows = bin.event_windows.value();
    s.silent_windows = bin.silent_windows.value();
    s.merged_windows = bin.merged_windows.value();
    s.window_events = bin.window_events.value();
    s.begin = from_us(std::int64_t(bin.begin_us.value()));
    s.window = {from_us(std::int64_t(bin.window_begin_us.value())),
                from_us(std::int64_t(bin.window_end_us.value()))};
    s.bin = bin.work.summary();

    s.encoded = encode.encoded.value();
    s.state_resets = encode.state_resets.value();
    s.encode = encode.work.summary();

    s.frames = present.frames.value();
    s.skipped_frames = present.skipped_frames.value();
    s.broken_frames = present.broken_frames.value();
    s.newest_frame = from_us(std::int64_t(present.newest_us.value()));
    s.latency = present.latency.summary();
    s.take = present.take.summary();
    s.render = present.render.summary();
    s.write = present.write.summary();
    return s;
}

}  // namespace eventide
