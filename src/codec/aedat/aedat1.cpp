// AEDAT 1.0, and the addresses of the DVS128.
#include "src/codec/aedat/aedat1.h"

#include "src/codec/aedat/aedat_header.h"

#include <algorithm>

namespace eventide {

Dvs128Address read_dvs128_address(std::uint32_t address) {
    // The chip's origin is at the lower right.
    return {std::uint16_t(127 - ((address >> 1) & 0x7F)),
            std::uint16_t(127 - ((address >> 8) & 0x7F)), (address & 1) != 0,
            (address & 0x8000) != 0};
}

void Dvs128Events::take(const AedatRecord& record, std::int64_t t_us, Batch& into, Damage& damage) {
    const Dvs128Address address = read_dvs128_address(record.address);
    if (record.address > 0xFFFF) {
        damage.count(DamageReason::unknown_word);
    } else if (address.external) {
        into.triggers.push_back({from_us(t_us), Trigger::Kind::pulse, 0});
    } else if (address.x >= width_ || address.y >= height_) {
        damage.count(DamageReason::out_of_range);
    } else if (last_event_us_ && t_us < *last_event_us_) {
        damage.count(DamageReason::time_backwards);
    } else {
        last_event_us_ = t_us;
        into.events.push_back(
            {from_us(t_us), address.x, address.y, Polarity(address.bit0 == one_is_on_)});
    }
}

bool looks_like_aedat1(std::span<const std::byte> first_bytes) {
    const AedatHeaderLines header = read_aedat_lines(first_bytes);
    if (header.lines.empty()) return false;
    if (header.lines[0].starts_with("!AER-DAT")) return header.lines[0].starts_with("!AER-DAT1");
    // Text recordings may begin with '#' too, and go on as text.
    const auto data = first_bytes.subspan(header.end)
                          .first(std::min<std::size_t>(64, first_bytes.size() - header.end));
    return std::any_of(data.begin(), data.end(), [](std::byte byte) {
        return byte < std::byte{0x20} && byte != std::byte{'\n'} && byte != std::byte{'\r'} &&
               byte != std::byte{'\t'};
    });
}

StreamHeader read_aedat1_header(std::span<const std::byte> first_bytes) {
    StreamHeader header;
    header.format = "aedat1";
    header.width = header.height = 128;
    header.sensor_name = "DVS128";
    header.data_offset = read_aedat_lines(first_bytes).end;
    return header;
}

}  // namespace eventide
