#include "src/codec/inivation/dvs128.h"

#include "src/core/byte_order.h"

namespace eventide {
namespace {
constexpr int kSide = 128;
constexpr std::uint16_t kWrapBit = 0x8000, kResetBit = 0x4000, kTimeMask = 0x3FFF;  // of the time
constexpr std::uint16_t kOffBit = 0x0001, kSyncBit = 0x8000;  // of the address
}  // namespace

void Dvs128Parser::parse(std::span<const std::byte> bytes, Batch& into) {
    records_.feed(bytes, [&](std::span<const std::byte> whole) {
        for (std::size_t at = 0; at < whole.size(); at += 4)
            record(load_little<std::uint16_t>(&whole[at]),
                   load_little<std::uint16_t>(&whole[at + 2]), into);
    });
}

void Dvs128Parser::record(std::uint16_t address, std::uint16_t time, Batch& into) {
    if ((time & kWrapBit) != 0) return clock_.wrap(1, damage_);
    if ((time & kResetBit) != 0) {  // the device counts from zero again, the stream goes on
        clock_.reset(damage_);
        into.triggers.push_back({clock_.now(), Trigger::Kind::timestamp_reset, 0});
        return;
    }
    if (!clock_.timestamp(time & kTimeMask, damage_)) return;
    if ((address & kSyncBit) != 0) {
        into.triggers.push_back({clock_.now(), Trigger::Kind::rising, 0});
        return;
    }
    const int x = (address >> 1) & (kSide - 1), y = (address >> 8) & (kSide - 1);
    into.events.push_back({clock_.now(), std::uint16_t(kSide - 1 - x), std::uint16_t(kSide - 1 - y),
                           (address & kOffBit) != 0 ? Polarity::off : Polarity::on});
}

void Dvs128Parser::finish(Batch&) {
    if (records_.is_half_read()) damage_.count(DamageReason::truncated);
    records_.drop();
}

void Dvs128Parser::resync() {
    records_.drop();
    clock_.forget();
}

std::optional<SensorTime> Dvs128Parser::clock() const {
    if (!clock_.is_known()) return std::nullopt;
    return clock_.now();
}

}  // namespace eventide
