#include "src/codec/inivation/dvxplorer.h"

#include "src/core/byte_order.h"

namespace eventide {
namespace {

constexpr std::uint16_t kTimestampBit = 0x8000, kDataMask = 0x0FFF;

}  // namespace

DvxplorerParser::DvxplorerParser(const DvxplorerSensor& sensor)
    : sensor_(sensor), imu_(imu_of(sensor)) {}

void DvxplorerParser::parse(std::span<const std::byte> bytes, Batch& into) {
    words_.feed(bytes, [&](std::span<const std::byte> whole) {
        for (std::size_t at = 0; at < whole.size(); at += 2)
            word(load_little<std::uint16_t>(&whole[at]), into);
    });
}

void DvxplorerParser::word(std::uint16_t w, Batch& into) {
    if ((w & kTimestampBit) != 0) {
        clock_.timestamp(std::uint16_t(w & ~kTimestampBit), damage_);
        return;
    }
    const std::uint16_t data = w & kDataMask;
    switch (w >> 12) {
        case 0:
            return special(data, into);
        case 1:
            column_ = data & 0x3FF;
            if (column_ >= sensor_.columns()) {
                damage_.count(DamageReason::out_of_range);
                column_ = -1;
            }
            return;
        case 2:
            return group(rows_[1], data, into);
        case 3:
            return group(rows_[0], data, into);
        case 4:
            return group_addresses(data);
        case 5:
            if ((data >> 8) == 0) return imu_.byte(std::uint8_t(data & 0xFF));
            if ((data >> 8) == 3) return imu_.scale(std::uint8_t(data & 0xFF));
            return damage_.count(DamageReason::unknown_word);
        case 7:
            return clock_.wrap(data, damage_);
        default:
            return damage_.count(DamageReason::unknown_word);
    }
}

/// Bits 0-5 the first group, 6-10 how far the second is from it, bit 11 set where it is before it.
void DvxplorerParser::group_addresses(std::uint16_t data) {
    const int first = data & 0x3F, offset = (data >> 6) & 0x1F;
    const int second = (data & 0x800) != 0 ? first - offset : first + offset;
    rows_ = {first * kDvxplorerRowsPerGroup, second * kDvxplorerRowsPerGroup};
}

/// A bit for each of eight rows; bit 8 clear means ON.
void DvxplorerParser::group(int first_row, std::uint16_t data, Batch& into) {
    if (!clock_.is_known() || column_ < 0 || rows_[0] < 0) return;  // after a loss
    const Polarity polarity = (data & 0x100) != 0 ? Polarity::off : Polarity::on;
    for (int i = 0; i < kDvxplorerRowsPerGroup; ++i) {
        if ((data & (1 << i)) == 0) continue;
        const int y = first_row + i;
        if (y < 0 || y >= sensor_.rows())
            damage_.count(DamageReason::out_of_range);
        else
            into.events.push_back(event_at(clock_.now(), column_, y, polarity, sensor_));
    }
}

void DvxplorerParser::imu_end(Batch& into) {
    ImuSample sample;
    switch (imu_.end(clock_.now(), sample)) {
        case DavisImuAssembler::End::complete:
            if (clock_.is_known()) into.imu.push_back(sample);
            return;
        case DavisImuAssembler::End::incomplete:
            return damage_.count(DamageReason::bad_record);
        case DavisImuAssembler::End::none:
            return;
    }
}

void DvxplorerParser::special(std::uint16_t data, Batch& into) {
    const auto trigger = [&](Trigger::Kind kind, std::uint8_t source) {
        if (clock_.is_known()) into.triggers.push_back({clock_.now(), kind, source});
    };
    switch (data) {
        case 0:
            return;
        case 1:
            clock_.reset(damage_);
            imu_.abandon();
            return trigger(Trigger::Kind::timestamp_reset, 0);
        case 2:
            return trigger(Trigger::Kind::falling, 0);
        case 3:
            return trigger(Trigger::Kind::rising, 0);
        case 4:
            return trigger(Trigger::Kind::pulse, 0);
        case 5:
            if (imu_.begin()) damage_.count(DamageReason::bad_record);
            return;
        case 7:
            return imu_end(into);
        case 16:
            return trigger(Trigger::Kind::falling, Trigger::kGenerator);
        case 17:
            return trigger(Trigger::Kind::rising, Trigger::kGenerator);
        default:
            return damage_.count(DamageReason::unknown_word);
    }
}

void DvxplorerParser::finish(Batch&) {
    if (words_.is_half_read()) damage_.count(DamageReason::truncated);
    words_.drop();
}

void DvxplorerParser::resync() {
    words_.drop();
    clock_.forget();
    imu_.abandon();
    column_ = -1;
    rows_ = {-1, -1};
}

std::optional<SensorTime> DvxplorerParser::clock() const {
    if (!clock_.is_known()) return std::nullopt;
    return clock_.now();
}

}  // namespace eventide
