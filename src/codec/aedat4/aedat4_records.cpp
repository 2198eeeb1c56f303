// The schemas of the vendor: events.fbs, frame.fbs, imu.fbs, trigger.fbs (docs/protocols.md
// D.3); fields are numbered in their order.
#include "src/codec/aedat4/aedat4_records.h"

#include <algorithm>
#include <array>

namespace eventide {

namespace {

using Kind = Trigger::Kind;

// Of inputs, only the first has numbers.
constexpr std::array<Trigger, 10> kTriggers{{{{}, Kind::timestamp_reset, 0},
                                             {{}, Kind::rising, 0},
                                             {{}, Kind::falling, 0},
                                             {{}, Kind::pulse, 0},
                                             {{}, Kind::rising, Trigger::kGenerator},
                                             {{}, Kind::falling, Trigger::kGenerator},
                                             {{}, Kind::frame_begin, 0},
                                             {{}, Kind::frame_end, 0},
                                             {{}, Kind::exposure_begin, 0},
                                             {{}, Kind::exposure_end, 0}}};

struct WireEvent {
    std::int64_t t_us;
    std::uint16_t x, y;
    bool on;
};

WireEvent load_event(const std::byte* record) {
    return {load_little<std::int64_t>(record), load_little<std::uint16_t>(record + 8),
            load_little<std::uint16_t>(record + 10), record[12] != std::byte{0}};
}

/// All records at once when none of them needs more than a look.
bool take_plain(std::span<const std::byte> records, EventValidator& validator, Batch& into) {
    constexpr std::size_t kAtOnce = 512;
    std::array<Event, kAtOnce> taken;
    const std::size_t n = records.size() / kAedat4EventBytes;
    if (n == 0 || n > kAtOnce) return false;
    const std::int64_t first = load_event(records.data()).t_us;
    const std::int64_t last = load_event(records.data() + records.size() - kAedat4EventBytes).t_us;
    if (!is_aedat4_time(first) || !is_aedat4_time(last)) return false;
    if (!validator.is_plain(first) || last - first > EventValidator::kLongestStep) return false;
    const std::uint64_t width = validator.width(), height = validator.height();
    bool plain = true;
    std::int64_t before = first;
    for (std::size_t i = 0; i < n; ++i) {
        const WireEvent event = load_event(records.data() + i * kAedat4EventBytes);
        plain &= (event.x < width) & (event.y < height) & (event.t_us >= before);
        before = event.t_us;
        taken[i] = {from_us(event.t_us), event.x, event.y, Polarity(event.on)};
    }
    if (!plain) return false;
    into.events.insert(into.events.end(), taken.begin(), taken.begin() + std::ptrdiff_t(n));
    validator.pass(last);
    return true;
}

/// Whether a clock that was reset to `anew_us` tells this time, after `newest_us`. Cameras whose
/// times go on have triggers a little in the past, and no event before another.
bool is_anew(std::int64_t t_us, std::int64_t anew_us, std::int64_t newest_us) {
    return t_us >= anew_us && t_us < newest_us &&
           (t_us < newest_us - kAedat4ResetUs || t_us < anew_us + kAedat4ResetUs);
}

void take_one_by_one(std::span<const std::byte> records, EventValidator& validator,
                     std::optional<std::int64_t>& anew_us, Batch& into, Damage& damage) {
    for (; !records.empty(); records = records.subspan(kAedat4EventBytes)) {
        const WireEvent event = load_event(records.data());
        const auto newest = validator.newest_us();
        if (anew_us && newest && is_anew(event.t_us, *anew_us, *newest)) {
            validator.finish(into, damage);
            validator.resync(damage);
            anew_us.reset();
        }
        if (is_aedat4_time(event.t_us))
            validator.add(event.t_us, event.x, event.y, event.on, into, damage);
        else
            damage.count(DamageReason::bad_record);
    }
}

struct PixelFormat {
    int channels, bytes;
};

/// The format's numbers are OpenCV's: depth in bits 2-0 (0 u8, 2 u16), channels - 1 above.
std::optional<PixelFormat> pixel_format(std::int8_t number) {
    const int depth = number & 7, channels = (number >> 3) + 1;
    if (number < 0 || (depth != 0 && depth != 2)) return {};
    if (channels != 1 && channels != 3 && channels != 4) return {};
    return PixelFormat{channels, depth == 0 ? 1 : 2};
}

constexpr std::int64_t kLongestExposure = 60'000'000;  // us

/// False when the times contradict each other.
bool place_in_time(const FlatTable& frame, ReferenceImage& image) {
    const auto stamp = frame.scalar<std::int64_t>(0);
    auto begin = frame.scalar<std::int64_t>(3), end = frame.scalar<std::int64_t>(4);
    const auto exposure = frame.scalar<std::int64_t>(11);
    if (begin == 0 && end == 0) {
        // Newer recorders stamp the begin of the exposure and give its length; older ones stamp
        // the middle and give begin and end.
        if (exposure < 0 || exposure > kLongestExposure) return false;
        begin = stamp;
        end = stamp + exposure;
    }
    if (!is_aedat4_time(stamp) || !is_aedat4_time(begin) || !is_aedat4_time(end)) return false;
    if (end < begin) return false;
    image.exposure_begin = from_us(begin);
    image.exposure_end = from_us(end);
    image.t = from_us(end > begin ? begin + (end - begin) / 2 : stamp);
    if (end == begin) image.exposure_begin = image.exposure_end = image.t;
    return true;
}

void copy_pixels(std::span<const std::byte> from, int bytes_each, std::span<std::uint16_t> to) {
    for (std::size_t i = 0; i < to.size(); ++i)
        to[i] = bytes_each == 1 ? std::uint16_t(std::to_integer<unsigned>(from[i]) * 257)
                                : load_little<std::uint16_t>(from.data() + 2 * i);
}

void keep_newest(std::optional<std::int64_t>& newest, std::int64_t t_us) {
    if (!newest || t_us > *newest) newest = t_us;
}

}  // namespace

std::optional<std::int64_t> take_aedat4_events(const FlatTable& packet, EventValidator& validator,
                                               std::optional<std::int64_t>& anew_us, Batch& into,
                                               Damage& damage) {
    const auto elements = packet.vector(0, kAedat4EventBytes);
    if (!elements) {
        damage.count(DamageReason::bad_record);
        return {};
    }
    constexpr std::size_t kChunkBytes = 512 * kAedat4EventBytes;
    for (auto records = elements->bytes; !records.empty();) {
        const auto chunk = records.first(std::min(kChunkBytes, records.size()));
        if (!take_plain(chunk, validator, into))
            take_one_by_one(chunk, validator, anew_us, into, damage);
        records = records.subspan(chunk.size());
    }
    validator.end_packet();
    return validator.newest_us();
}

std::optional<std::int64_t> take_aedat4_image(const FlatTable& frame, const EventValidator& sensor,
                                              Batch& into, Damage& damage) {
    const int width = frame.scalar<std::int16_t>(6), height = frame.scalar<std::int16_t>(7);
    const auto format = pixel_format(frame.scalar<std::int8_t>(5));
    const auto pixels = frame.vector(10, 1);
    ReferenceImage image;
    if (!format || !pixels || width <= 0 || height <= 0 || !place_in_time(frame, image) ||
        pixels->size != std::size_t(width) * std::size_t(height) *
                            std::size_t(format->channels * format->bytes)) {
        damage.count(DamageReason::bad_record);
        return {};
    }
    image.x0 = frame.scalar<std::int16_t>(8);
    image.y0 = frame.scalar<std::int16_t>(9);
    if (image.x0 < 0 || image.y0 < 0 || std::uint64_t(image.x0 + width) > sensor.width() ||
        std::uint64_t(image.y0 + height) > sensor.height()) {
        damage.count(DamageReason::out_of_range);
        return {};
    }
    image.channels = format->channels;
    image.pixels = Array2<std::uint16_t>(height, width * format->channels);
    copy_pixels(pixels->bytes, format->bytes, image.pixels.values());
    const std::int64_t newest = to_us(image.exposure_end);
    into.add_image(std::move(image));
    return newest;
}

namespace {

/// Calls take(record, time) for each of a packet's records that has a time; the others are damage.
template <typename Take>
std::optional<std::int64_t> take_timed_records(const FlatTable& packet, Damage& damage,
                                               const Take& take) {
    std::optional<std::int64_t> newest;
    const auto elements = packet.vector(0, 4);
    if (!elements) damage.count(DamageReason::bad_record);
    for (std::size_t i = 0; elements && i < elements->size; ++i) {
        const auto record = packet.element(*elements, i);
        if (!record || !is_aedat4_time(record->scalar<std::int64_t>(0))) {
            damage.count(DamageReason::bad_record);
            continue;
        }
        const auto t = record->scalar<std::int64_t>(0);
        take(*record, from_us(t));
        keep_newest(newest, t);
    }
    return newest;
}

}  // namespace

std::optional<std::int64_t> take_aedat4_imu(const FlatTable& packet, Batch& into, Damage& damage) {
    return take_timed_records(packet, damage, [&](const FlatTable& record, SensorTime t) {
        ImuSample sample;
        sample.t = t;
        sample.temperature_c = record.scalar<float>(1);
        for (int axis = 0; axis < 3; ++axis) {
            const auto at = std::size_t(axis);
            sample.acceleration_g[at] = record.scalar<float>(2 + axis);
            sample.gyro_dps[at] = record.scalar<float>(5 + axis);
            sample.magnetic_ut[at] = record.scalar<float>(8 + axis);
        }
        into.imu.push_back(sample);
    });
}

std::optional<std::int64_t> take_aedat4_triggers(const FlatTable& packet, Batch& into,
                                                 Damage& damage) {
    return take_timed_records(packet, damage, [&](const FlatTable& record, SensorTime t) {
        const auto number = record.scalar<std::uint8_t>(1);
        Trigger trigger =
            number < kTriggers.size() ? kTriggers[number] : Trigger{{}, Kind::other, number};
        trigger.t = t;
        into.triggers.push_back(trigger);
    });
}

int aedat4_trigger_number(const Trigger& trigger) {
    for (std::size_t i = 0; i < kTriggers.size(); ++i)
        if (kTriggers[i].kind == trigger.kind && kTriggers[i].source == trigger.source)
            return int(i);
    if (trigger.kind == Kind::other && trigger.source >= kTriggers.size() && trigger.source < 128)
        return trigger.source;
    return -1;
}

}  // namespace eventide
