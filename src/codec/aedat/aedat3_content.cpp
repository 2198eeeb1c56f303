// Records of AEDAT 3 -> events, frames, IMU samples, triggers.
#include "src/codec/aedat/aedat3_content.h"

#include "src/codec/aedat/aedat3_records.h"
#include "src/core/byte_order.h"

#include <algorithm>
#include <utility>

namespace eventide {

namespace {

constexpr std::uint32_t kInvalidStamp = 1U << 31;  // and above: stamps have 31 bits
constexpr std::uint32_t kLastStamp = kInvalidStamp - 1;

struct PolarityWord {
    std::uint32_t bits;
    bool is_valid() const { return (bits & 1) != 0; }
    bool is_on() const { return (bits & 2) != 0; }
    std::uint32_t x() const { return bits >> 17; }
    std::uint32_t y() const { return (bits >> 2) & 0x7FFF; }
};

}  // namespace

Aedat3Content::Aedat3Content(bool lower_left, int rows, int width, int height)
    : lower_left_(lower_left),
      rows_(std::uint64_t(rows)),
      validator_(std::uint64_t(width), std::uint64_t(height),
                 EventValidator::LeapEnds::with_next_packet) {}

/// A reset sets the camera's clock to zero, and a new stream begins; so does a file that was joined
/// to this one. Files written after the fact have no step back, and need nothing.
void Aedat3Content::begin_anew_after_reset(std::int64_t t_us, Batch& into) {
    const auto last = validator_.newest_us();
    if (may_begin_anew() && last && t_us < *last) {
        validator_.finish(into, damage_);
        validator_.resync(damage_);
        told_ = {};
        if (!was_reset_)
            into.triggers.push_back({from_us(t_us), Trigger::Kind::timestamp_reset, 0});
    }
    was_reset_ = is_joined_ = false;
}

void Aedat3Content::take_event(const std::byte* record, Batch& into) {
    const PolarityWord word{load_little<std::uint32_t>(record)};
    const auto stamp = load_little<std::uint32_t>(record + 4);
    if (!word.is_valid()) return;  // left out by the recorder's filters
    if (stamp >= kInvalidStamp) {
        damage_.count(DamageReason::bad_record);
        return;
    }
    begin_anew_after_reset(base_us_ + stamp, into);
    std::uint64_t y = word.y();
    if (lower_left_) y = rows_ - 1 - y;
    validator_.add(base_us_ + stamp, word.x(), y, word.is_on(), into, damage_);
    if (const auto newest = validator_.newest_us()) told_.tell_by_events(*newest);
}

/// Takes records up to `end`, or up to the first that is not plain, which it returns: like
/// take_event() for each, with one look per record. The first one's stamp is plain.
const std::byte* Aedat3Content::take_plain_events(const std::byte* record, const std::byte* end,
                                                  Batch& into) {
    const auto width = std::uint32_t(validator_.width()),
               height = std::uint32_t(validator_.height());
    const std::size_t before = into.events.size();
    into.events.resize(before + std::size_t(end - record) / Aedat3Packet::kPolarityBytes);
    Event* out = into.events.data() + before;
    // Above kLastStamp nothing is plain, so stamps need no look of their own.
    std::int64_t newest = *validator_.newest_us() - base_us_;
    for (; record < end; record += Aedat3Packet::kPolarityBytes) {
        const PolarityWord word{load_little<std::uint32_t>(record)};
        const std::int64_t stamp = load_little<std::uint32_t>(record + 4);
        // Not &&: six branches a record cost more than six comparisons.
        const int plain = int(word.is_valid()) & int(word.x() < width) & int(word.y() < height) &
                          int(stamp >= newest) & int(stamp <= std::int64_t(kLastStamp)) &
                          int(stamp - newest <= EventValidator::kLongestStep);
        if (plain == 0) break;
        *out++ = {from_us(base_us_ + stamp), std::uint16_t(word.x()), std::uint16_t(word.y()),
                  Polarity(word.is_on())};
        newest = stamp;
    }
    into.events.resize(std::size_t(out - into.events.data()));
    validator_.pass(base_us_ + newest);
    told_.tell_by_events(base_us_ + newest);
    return record;
}

void Aedat3Content::take_events(std::span<const std::byte> records, Batch& into) {
    constexpr std::size_t kBytes = Aedat3Packet::kPolarityBytes;
    constexpr std::size_t kBlock = 512;  // records: bounds what a damaged one makes us do again
    const std::byte* record = records.data();
    const std::byte* const end = record + records.size();
    while (record < end) {
        const auto stamp = load_little<std::uint32_t>(record + 4);
        if (!lower_left_ && !may_begin_anew() && validator_.is_plain(base_us_ + stamp)) {
            const auto left = std::size_t(end - record) / kBytes;
            const std::byte* const block_end = record + std::min(kBlock, left) * kBytes;
            record = take_plain_events(record, block_end, into);
            if (record == block_end) continue;
        }
        take_event(record, into);
        record += kBytes;
    }
}

void Aedat3Content::take_special(const std::byte* record, Batch& into) {
    const auto word = load_little<std::uint32_t>(record);
    const auto stamp = load_little<std::uint32_t>(record + 4);
    if ((word & 1) == 0) return;
    auto trigger = read_special(word);
    const bool is_reset = trigger && trigger->kind == Trigger::Kind::timestamp_reset;
    if (stamp >= kInvalidStamp) {
        damage_.count(DamageReason::bad_record);
        return;
    }
    // Recorders stamp resets with the last possible time, which is none: what begins is zero. With
    // the old clock's last time nobody could tell that the reset comes behind it.
    if (is_reset && stamp == kLastStamp) {
        trigger->t = from_us(base_us_);
    } else {
        told_.tell(base_us_ + stamp);
        if (trigger) trigger->t = from_us(base_us_ + stamp);
    }
    if (trigger) into.triggers.push_back(*trigger);
    was_reset_ |= is_reset;
}

void Aedat3Content::take_frame(std::span<const std::byte> record, Batch& into) {
    if ((load_little<std::uint32_t>(record.data()) & 1) == 0) return;
    auto image = read_frame(record, base_us_, lower_left_, int(rows_));
    if (!image) {
        damage_.count(DamageReason::bad_record);
        return;
    }
    const int width = image->pixels.width() / image->channels, height = image->pixels.height();
    if (image->y0 < 0 || std::uint64_t(image->x0 + width) > validator_.width() ||
        std::uint64_t(image->y0 + height) > validator_.height()) {
        damage_.count(DamageReason::out_of_range);
        return;
    }
    told_.tell(to_us(image->exposure_end));
    into.add_image(std::move(*image));
}

void Aedat3Content::begin(const Aedat3Packet& packet) {
    base_us_ = std::int64_t(packet.overflow) << 31;
    if (Aedat3Type(packet.type) == Aedat3Type::polarity) validator_.end_packet();
    told_.end_packet();
}

void Aedat3Content::take(const Aedat3Packet& packet, std::span<const std::byte> records,
                         Batch& into) {
    if (Aedat3Type(packet.type) == Aedat3Type::polarity) return take_events(records, into);
    for (; !records.empty(); records = records.subspan(packet.record_bytes))
        take_one(Aedat3Type(packet.type), records.first(packet.record_bytes), into);
}

void Aedat3Content::take_one(Aedat3Type type, std::span<const std::byte> record, Batch& into) {
    switch (type) {
        case Aedat3Type::special:
            return take_special(record.data(), into);
        case Aedat3Type::polarity:
            return take_events(record, into);
        case Aedat3Type::frame:
            return take_frame(record, into);
        case Aedat3Type::imu6:
        case Aedat3Type::imu9:
            if ((load_little<std::uint32_t>(record.data()) & 1) == 0) return;
            into.imu.push_back(read_imu(record, base_us_));
            told_.tell(to_us(into.imu.back().t));
    }
}

void Aedat3Content::finish(Batch& into) {
    validator_.finish(into, damage_);
    if (const auto newest = validator_.newest_us()) told_.tell_by_events(*newest);
    told_.finish();
}

void Aedat3Content::resync() {
    was_reset_ = is_joined_ = false;
    told_ = {};
    validator_.resync(damage_);
}

}  // namespace eventide
