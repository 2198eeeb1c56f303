#include "src/codec/inivation/dvxplorer_mini.h"

#include "src/core/byte_order.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace eventide {
namespace {

constexpr std::uint32_t kMessageBit = 0x02000000;
constexpr std::size_t kWordBytes = 4;

}  // namespace

void frame_mini_message(std::vector<std::byte>& message) {
    const auto header = little_bytes(kMessageBit | std::uint32_t(message.size()));
    message.resize((message.size() + kWordBytes - 1) / kWordBytes * kWordBytes);
    message.insert(message.begin(), header.begin(), header.end());
}

void DvxplorerMiniParser::parse(std::span<const std::byte> bytes, Batch& into) {
    words_.feed(bytes, [&](std::span<const std::byte> whole) {
        for (std::size_t at = 0; at < whole.size(); at += 4)
            word(load_little<std::uint32_t>(&whole[at]), into);
    });
}

void DvxplorerMiniParser::word(std::uint32_t w, Batch& into) {
    constexpr std::uint32_t kGroup = 1U << 31, kReference = 0x08000000, kColumn = 0x04000000;
    if (message_read_ < message_bytes_) return message_word(w, into);
    if (w == 0) return;  // padding
    if ((w & kGroup) != 0) {
        const int first = int((w >> 18) & 0x3F), second = first + int((w >> 26) & 0x1F);
        group(first * kDvxplorerRowsPerGroup, w & 0xFF, (w & (1U << 16)) != 0, into);
        group(second * kDvxplorerRowsPerGroup, (w >> 8) & 0xFF, (w & (1U << 17)) != 0, into);
    } else if ((w & kColumn) != 0) {
        column(w);
    } else if ((w & kReference) != 0) {
        constexpr std::int64_t kMs = 1000;
        reference((w & 0x3FFFFF) * kMs);
    } else {
        begin_message(w);
    }
}

constexpr std::int64_t kReferenceWrapUs = (std::int64_t{1} << 22) * 1000;  // 70 minutes

/// A small step back is noise, a large one a wrap.
void DvxplorerMiniParser::reference(std::int64_t us) {
    if (reference_ < 0) {
        settle(us);
    } else if (us < reference_ - kReferenceWrapUs / 2) {
        base_ += kReferenceWrapUs;
    } else if (us < reference_) {
        return damage_.count(DamageReason::time_backwards);
    }
    reference_ = us;
    time_ = std::max(time_, base_ + us);
    told_at_ = arrived_;
}

/// The first reference since the start or a loss. Whole wraps may be missing, or all that was
/// before.
void DvxplorerMiniParser::settle(std::int64_t us) {
    constexpr std::int64_t kBeganAnewUs = 2'000'000;
    const bool host_knows = arrived_ && told_at_;
    const std::int64_t expected =
        host_knows
            ? time_ + std::chrono::duration_cast<SensorDuration>(*arrived_ - *told_at_).count()
            : time_;
    const double wraps = std::round(double(expected - base_ - us) / double(kReferenceWrapUs));
    base_ += std::max(std::int64_t{0}, std::int64_t(wraps)) * kReferenceWrapUs;
    const bool far_off = host_knows && std::abs(base_ + us - expected) > kBeganAnewUs;
    if (far_off || base_ + us < time_) base_ = expected - us;
}

/// Words were lost, a reference perhaps among them, and without it what follows would be too early.
void DvxplorerMiniParser::forget_reference(DamageReason why) {
    reference_ = -1;
    damage_.count(why);
}

/// Bits 9-0 x; 20-11 the frame's time after the reference, where bit 21 marks its first column.
void DvxplorerMiniParser::column(std::uint32_t w) {
    const int x = int(w & 0x3FF);
    const bool begins_frame = (w & (1U << 21)) != 0;
    if (reference_ < 0 || (!begins_frame && column_ < 0)) return;
    const int before = begins_frame ? -1 : column_;
    column_ = -1;
    if (begins_frame) {
        const std::int64_t time = base_ + reference_ + ((w >> 11) & 0x3FF);
        if (time < time_) return forget_reference(DamageReason::time_backwards);
        time_ = time;
    }
    if (x >= sensor_.columns()) return damage_.count(DamageReason::out_of_range);
    if (x <= before) return forget_reference(DamageReason::bad_record);
    column_ = x;
}

void DvxplorerMiniParser::group(int first_row, std::uint32_t mask, bool off, Batch& into) {
    if (reference_ < 0 || column_ < 0) return;
    for (int i = 0; i < kDvxplorerRowsPerGroup; ++i) {
        if ((mask & (1U << i)) == 0) continue;
        const int y = first_row + i;
        if (y >= sensor_.rows())
            damage_.count(DamageReason::out_of_range);
        else
            into.events.push_back(
                event_at(from_us(time_), column_, y, off ? Polarity::off : Polarity::on, sensor_));
    }
}

void DvxplorerMiniParser::begin_message(std::uint32_t header) {
    const std::uint32_t length = header ^ kMessageBit;
    if (length == 0 || length > message_.size()) return damage_.count(DamageReason::unknown_word);
    message_bytes_ = length;
    message_read_ = 0;
}

void DvxplorerMiniParser::message_word(std::uint32_t word, Batch& into) {
    std::ranges::copy(little_bytes(word), message_.begin() + std::ptrdiff_t(message_read_));
    message_read_ = std::min(message_read_ + kWordBytes, message_bytes_);
    if (message_read_ == message_bytes_) message(std::span{message_}.first(message_bytes_), into);
}

/// Kind; of an IMU sample then what is there and in which ranges, as the FX3 board's scale word;
/// gyroscope z y x, accelerometer z y x, temperature: the chip lies on its side. The camera's own
/// texts have kind 0.
void DvxplorerMiniParser::message(std::span<const std::byte> bytes, Batch& into) {
    constexpr std::byte kImu{1};
    constexpr std::size_t kImuBytes = 16;
    if (bytes.size() != kImuBytes || bytes[0] != kImu)
        return damage_.count(DamageReason::unknown_word);
    if (reference_ < 0) return;
    struct Part {
        unsigned flag;
        std::array<std::size_t, 3> at;  // in the assembler's order: y x z
    };
    constexpr Part kAccel{0x80, {10, 12, 8}}, kGyro{0x40, {4, 6, 2}};
    constexpr unsigned kTemperature = 0x20;
    const auto flags = std::to_integer<std::uint8_t>(bytes[1]);
    const auto number = [&](std::size_t at) {
        imu_.byte(std::to_integer<std::uint8_t>(bytes[at + 1]));
        imu_.byte(std::to_integer<std::uint8_t>(bytes[at]));
    };
    const auto part = [&](const Part& p) {
        if ((flags & p.flag) != 0) std::ranges::for_each(p.at, number);
    };
    imu_.begin();
    imu_.scale(flags);
    part(kAccel);
    if ((flags & kTemperature) != 0) number(14);
    part(kGyro);
    ImuSample sample;
    if (imu_.end(from_us(time_), sample) == DavisImuAssembler::End::complete)
        into.imu.push_back(sample);
}

void DvxplorerMiniParser::finish(Batch&) {
    if (words_.is_half_read() || message_read_ < message_bytes_)
        damage_.count(DamageReason::truncated);
    words_.drop();
    message_read_ = message_bytes_;
}

void DvxplorerMiniParser::resync() {
    words_.drop();
    message_read_ = message_bytes_;
    reference_ = -1;
    column_ = -1;
}

std::optional<SensorTime> DvxplorerMiniParser::clock() const {
    if (reference_ < 0) return std::nullopt;
    return from_us(time_);
}

}  // namespace eventide
