#include "src/codec/dvs128.h"

#include <algorithm>
#include <cmath>

namespace eventide {
namespace {
constexpr int kSide = 128;
constexpr std::int64_t kWrapUs = 1 << 14;
constexpr std::uint8_t kWrapBit = 0x80, kResetBit = 0x40;
}  // namespace

void Dvs128Parser::parse(std::span<const std::byte> bytes, Batch& into) {
    for (const std::byte byte : bytes) {
        record_[filled_++] = std::uint8_t(byte);
        if (filled_ < record_.size()) continue;
        filled_ = 0;
        record(into);
    }
}

void Dvs128Parser::catch_up(std::int64_t candidate) {
    if (!expected_) return;
    const double wraps = std::round(double(*expected_ - candidate) / double(kWrapUs));
    if (wraps > 0) wrap_add_ += std::int64_t(wraps) * kWrapUs;
    expected_.reset();
}

void Dvs128Parser::record(Batch& into) {
    if ((record_[3] & kWrapBit) != 0) {
        wrap_add_ += kWrapUs;
        catch_up(wrap_add_);
        time_ = std::max(time_, wrap_add_);
        time_known_ = true;
        return;
    }
    if ((record_[3] & kResetBit) != 0) {  // the device counts from zero again, the stream goes on
        wrap_add_ = time_ = std::max(time_, expected_.value_or(time_));
        expected_.reset();
        time_known_ = true;
        into.triggers.push_back({from_us(time_), Trigger::Kind::timestamp_reset, 0});
        return;
    }
    const std::int64_t low = record_[2] | ((record_[3] & 0x3F) << 8);
    catch_up(wrap_add_ + low);
    const std::int64_t time = wrap_add_ + low;
    if (time < time_) return damage_.count(DamageReason::time_backwards);
    time_ = time;
    time_known_ = true;
    if ((record_[1] & 0x80) != 0) {
        into.triggers.push_back({from_us(time_), Trigger::Kind::rising, 0});
        return;
    }
    const int x = record_[0] >> 1, y = record_[1] & 0x7F;
    into.events.push_back({from_us(time_), std::uint16_t(kSide - 1 - x),
                           std::uint16_t(kSide - 1 - y),
                           (record_[0] & 1) == 0 ? Polarity::on : Polarity::off});
}

void Dvs128Parser::finish(Batch&) {
    if (filled_ != 0) damage_.count(DamageReason::truncated);
    filled_ = 0;
}

void Dvs128Parser::resync() {
    filled_ = 0;
    time_known_ = false;
}

std::optional<SensorTime> Dvs128Parser::clock() const {
    if (!time_known_) return std::nullopt;
    return from_us(time_);
}

}  // namespace eventide
