// AEDAT 2.0 addresses -> events, frames, IMU samples, triggers.
#include "src/codec/aedat/aedat2.h"

#include "src/codec/aedat/aedat_header.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"
#include "src/core/lower_case.h"

#include <algorithm>
#include <array>
#include <string>

namespace eventide {

namespace {

struct Chip {
    std::string_view name;  ///< found in the AEChip line, in lower case
    std::string_view title;
    Aedat2Sensor sensor;
    int width, height;
};
constexpr std::array kChips{
    Chip{"dvs128", "DVS128", Aedat2Sensor::dvs128, 128, 128},
    Chip{"tmpdiff128", "DVS128", Aedat2Sensor::dvs128, 128, 128},
    Chip{"davis240", "DAVIS240", Aedat2Sensor::davis240, 240, 180},
    Chip{"sbret", "DAVIS240", Aedat2Sensor::davis240, 240, 180},
    Chip{"davis346", "DAVIS346", Aedat2Sensor::davis, 346, 260},
    Chip{"davis208", "DAVIS208", Aedat2Sensor::davis, 208, 192},
    Chip{"davis128", "DAVIS128", Aedat2Sensor::davis, 128, 128},
    Chip{"davis640", "DAVIS640", Aedat2Sensor::davis, 640, 480},
};

const Chip* find_chip(std::string_view named) {
    const std::string lower = lower_case(named);
    for (const Chip& chip : kChips)
        if (lower.find(chip.name) != lower.npos) return &chip;
    return nullptr;
}

/// A DAVIS uses such addresses only in a corner of its last row.
bool has_short_addresses(std::span<const std::byte> records) {
    for (; records.size() >= 8; records = records.subspan(8))
        if (load_big<std::uint32_t>(records.data()) > 0xFFFF) return false;
    return true;
}

}  // namespace

Aedat2Header read_aedat2_header(std::span<const std::byte> first_bytes, int stated_width,
                                int stated_height) {
    const AedatHeaderLines lines = read_aedat_lines(first_bytes);
    Aedat2Header header;
    header.stream.format = "aedat2";
    header.stream.data_offset = lines.end;
    header.stream.source_text = find_value(lines, "HardwareInterface");
    const std::string_view named = find_value(lines, "AEChip");
    const bool stated = stated_width > 0 && stated_height > 0;
    if (const Chip* chip = find_chip(named)) {
        header.sensor = chip->sensor;
        header.stream.sensor_name = chip->title;
        header.stream.width = chip->width;
        header.stream.height = chip->height;
    } else if (stated ? stated_width == 128 && stated_height == 128
                      : named.empty() && has_short_addresses(first_bytes.subspan(lines.end))) {
        header.sensor = Aedat2Sensor::dvs128;
        header.stream.sensor_name = "DVS128";
        header.stream.width = header.stream.height = 128;
    } else if (stated) {
        const bool is_davis240 = stated_width == 240 && stated_height == 180;
        header.sensor = is_davis240 ? Aedat2Sensor::davis240 : Aedat2Sensor::davis;
        header.stream.width = stated_width;
        header.stream.height = stated_height;
    } else {
        throw Error(ErrorKind::input,
                    "AEDAT 2.0: expected an AEChip line that names a DVS128 or a DAVIS, found " +
                        (named.empty() ? "none" : "\"" + std::string(named.substr(0, 80)) + "\"") +
                        "; state the sensor's size with --input-size WIDTHxHEIGHT (128x128 is a "
                        "DVS128, any other a DAVIS)");
    }
    return header;
}

Aedat2Content::Aedat2Content(Aedat2Sensor sensor, int width, int height, bool one_is_on,
                             int shown_width, int shown_height)
    : sensor_(sensor),
      width_(std::uint32_t(width)),
      height_(std::uint32_t(height)),
      shown_width_(shown_width > 0 ? std::uint32_t(shown_width) : width_),
      shown_height_(shown_height > 0 ? std::uint32_t(shown_height) : height_),
      dvs128_(one_is_on, int(shown_width_), int(shown_height_)),
      frame_(sensor == Aedat2Sensor::dvs128 ? 0 : int(shown_width_),
             sensor == Aedat2Sensor::dvs128 ? 0 : int(shown_height_),
             sensor == Aedat2Sensor::davis240) {}

void Aedat2Content::add_event(std::uint32_t address, std::int64_t t_us, Batch& into,
                              Damage& damage) {
    // The chip's origin is at the lower left, and X is stored mirrored. What lies beyond the chip
    // becomes huge.
    const std::uint32_t x = width_ - 1 - (address >> 12 & 0x3FF);
    const std::uint32_t y = height_ - 1 - (address >> 22 & 0x1FF);
    if ((address >> 10 & 1) != 0) {
        into.triggers.push_back({from_us(t_us), Trigger::Kind::pulse, 0});
    } else if (!is_shown(x, y)) {
        damage.count(DamageReason::out_of_range);
    } else if (last_event_us_ && t_us < *last_event_us_) {
        damage.count(DamageReason::time_backwards);
    } else {
        last_event_us_ = t_us;
        into.events.push_back(
            {from_us(t_us), std::uint16_t(x), std::uint16_t(y), Polarity((address >> 11) & 1)});
    }
}

void Aedat2Content::take_davis(std::uint32_t address, std::int64_t t_us, Batch& into,
                               Damage& damage) {
    if ((address >> 31) == 0) {
        add_event(address, t_us, into, damage);
        return;
    }
    const unsigned kind = (address >> 10) & 3;
    const SensorTime t = from_us(t_us);
    if (kind == 3) {
        imu_.word((address >> 28) & 7, std::int16_t((address >> 12) & 0xFFFF), t, into, damage);
        return;
    }
    const std::uint32_t x = address >> 12 & 0x3FF;
    const std::uint32_t y = height_ - 1 - (address >> 22 & 0x1FF);
    if (kind == 2)
        damage.count(DamageReason::unknown_word);
    else if (!is_shown(x, y))
        damage.count(DamageReason::out_of_range);
    else
        frame_.read(kind == 1, int(x), int(y), std::uint16_t(address & 0x3FF), t, into, damage);
}

void Aedat2Content::take(const AedatRecord& record, std::int64_t t_us, Batch& into,
                         Damage& damage) {
    if (sensor_ == Aedat2Sensor::dvs128)
        dvs128_.take(record, t_us, into, damage);
    else
        take_davis(record.address, t_us, into, damage);
}

void Aedat2Content::end_of_file(Batch& into, Damage& damage) {
    frame_.finish(into, damage);
    imu_.finish(damage);
}

void Aedat2Content::resync() {
    dvs128_.resync();
    frame_.drop();
    imu_.drop();
    last_event_us_.reset();
}

}  // namespace eventide
