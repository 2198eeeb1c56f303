// AEDAT 3 packets -> events, frames, IMU samples, triggers.
#include "src/codec/aedat/aedat3.h"

#include "src/codec/aedat/aedat3_records.h"
#include "src/core/byte_order.h"

#include <algorithm>
#include <cstring>
#include <string_view>

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

bool begins_file(std::span<const std::byte> bytes) {
    constexpr std::string_view kFirstLine = "#!AER-DAT3.";
    return std::memcmp(bytes.data(), kFirstLine.data(), kFirstLine.size()) == 0;
}

}  // namespace

Aedat3Parser::Aedat3Parser(const Aedat3Header& header, int width, int height)
    : lower_left_(header.lower_left),
      rows_(std::uint64_t(header.stream.height > 0 ? header.stream.height : height)),
      source_(header.source),
      others_(header.others),
      validator_(std::uint64_t(width), std::uint64_t(height)) {}

void Aedat3Parser::move_clock(std::int64_t t_us) {
    newest_us_ = std::max(newest_us_.value_or(t_us), t_us);
}

/// Slides over the bytes until 28 of them make a header.
std::span<const std::byte> Aedat3Parser::search_header(std::span<const std::byte> bytes) {
    while (true) {
        if (unit_.size() == Aedat3Packet::kHeaderBytes) {
            const Aedat3Packet packet = read_aedat3_packet(unit_.data());
            const bool of_ours = !source_ || packet.source == *source_;
            if (is_plausible(packet) && packet.number > 0 && of_ours) {
                begin_packet(packet);
                return bytes;
            }
            unit_.erase(unit_.begin());
        }
        const std::size_t n = std::min(Aedat3Packet::kHeaderBytes - unit_.size(), bytes.size());
        if (n == 0) return bytes;
        unit_.insert(unit_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(n));
        bytes = bytes.subspan(n);
    }
}

std::span<const std::byte> Aedat3Parser::read_header(std::span<const std::byte> bytes) {
    const std::size_t n = std::min(Aedat3Packet::kHeaderBytes - unit_.size(), bytes.size());
    unit_.insert(unit_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(n));
    bytes = bytes.subspan(n);
    if (unit_.size() < Aedat3Packet::kHeaderBytes) return bytes;
    const Aedat3Packet packet = read_aedat3_packet(unit_.data());
    if (is_plausible(packet)) {
        begin_packet(packet);
        return bytes;
    }
    state_ = State::searching;
    if (begins_file(unit_))
        is_joined_ = true;
    else
        damage_.count(DamageReason::bad_length);
    return bytes;
}

void Aedat3Parser::begin_packet(const Aedat3Packet& packet) {
    unit_.clear();
    packet_ = packet;
    const bool of_other_source = source_ && packet.source != *source_;
    const bool is_named =
        std::ranges::find(others_, int(packet.source), &Aedat3Source::number) != others_.end();
    if (of_other_source && !is_named) damage_.count(DamageReason::unknown_word);
    if (of_other_source || packet.type > std::int16_t(Aedat3Type::imu9)) {
        left_ = std::uint64_t(packet.record_bytes) * packet.number;
        state_ = State::passing_over;
    } else {
        if (!source_) source_ = packet.source;
        left_ = packet.number;
        base_us_ = std::int64_t(packet.overflow) << 31;
        state_ = State::records;
    }
    if (left_ == 0) state_ = State::header;
}

std::span<const std::byte> Aedat3Parser::pass_over(std::span<const std::byte> bytes) {
    const auto n = std::size_t(std::min<std::uint64_t>(left_, bytes.size()));
    left_ -= n;
    if (left_ == 0) state_ = State::header;
    return bytes.subspan(n);
}

/// A reset sets the camera's clock to zero, and a new stream begins; so does a file that was joined
/// to this one. Files written after the fact have no step back, and need nothing.
void Aedat3Parser::begin_anew_after_reset(std::int64_t t_us, Batch& into) {
    const auto last = validator_.newest_us();
    if (may_begin_anew() && last && t_us < *last) {
        validator_.finish(into, damage_);
        validator_.resync(damage_);
        newest_us_.reset();
        if (!was_reset_)
            into.triggers.push_back({from_us(t_us), Trigger::Kind::timestamp_reset, 0});
    }
    was_reset_ = is_joined_ = false;
}

void Aedat3Parser::take_event(const std::byte* record, Batch& into) {
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
    if (const auto newest = validator_.newest_us()) move_clock(*newest);
}

/// Takes records up to `end`, or up to the first that is not plain, which it returns: like
/// take_event() for each, with one look per record. The first one's stamp is plain.
const std::byte* Aedat3Parser::take_plain_events(const std::byte* record, const std::byte* end,
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
    move_clock(base_us_ + newest);
    return record;
}

void Aedat3Parser::take_many_events(std::span<const std::byte> records, Batch& into) {
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

void Aedat3Parser::take_special(const std::byte* record, Batch& into) {
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
        move_clock(base_us_ + stamp);
        if (trigger) trigger->t = from_us(base_us_ + stamp);
    }
    if (trigger) into.triggers.push_back(*trigger);
    was_reset_ |= is_reset;
}

void Aedat3Parser::take_frame(std::span<const std::byte> record, Batch& into) {
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
    move_clock(to_us(image->exposure_end));
    into.add_image(std::move(*image));
}

void Aedat3Parser::take(std::span<const std::byte> record, Batch& into) {
    switch (Aedat3Type(packet_.type)) {
        case Aedat3Type::special:
            take_special(record.data(), into);
            break;
        case Aedat3Type::polarity:
            take_event(record.data(), into);
            break;
        case Aedat3Type::frame:
            take_frame(record, into);
            break;
        case Aedat3Type::imu6:
        case Aedat3Type::imu9:
            if ((load_little<std::uint32_t>(record.data()) & 1) == 0) break;
            into.imu.push_back(read_imu(record, base_us_));
            move_clock(to_us(into.imu.back().t));
            break;
    }
}

std::span<const std::byte> Aedat3Parser::read_records(std::span<const std::byte> bytes,
                                                      Batch& into) {
    const std::size_t record_bytes = packet_.record_bytes;
    if (unit_.empty()) {
        const auto whole = std::size_t(std::min<std::uint64_t>(left_, bytes.size() / record_bytes));
        const auto records = bytes.first(whole * record_bytes);
        if (Aedat3Type(packet_.type) == Aedat3Type::polarity)
            take_many_events(records, into);
        else
            for (std::size_t i = 0; i < whole; ++i)
                take(records.subspan(i * record_bytes, record_bytes), into);
        left_ -= whole;
        bytes = bytes.subspan(records.size());
    }
    if (left_ > 0 && !bytes.empty()) {
        const std::size_t n = std::min(record_bytes - unit_.size(), bytes.size());
        unit_.insert(unit_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(n));
        bytes = bytes.subspan(n);
        if (unit_.size() == record_bytes) {
            take(unit_, into);
            unit_.clear();
            --left_;
        }
    }
    if (left_ == 0) state_ = State::header;
    return bytes;
}

void Aedat3Parser::parse(std::span<const std::byte> bytes, Batch& into) {
    while (!bytes.empty()) switch (state_) {
            case State::header:
                bytes = read_header(bytes);
                break;
            case State::searching:
                bytes = search_header(bytes);
                break;
            case State::records:
                bytes = read_records(bytes, into);
                break;
            case State::passing_over:
                bytes = pass_over(bytes);
                break;
        }
}

void Aedat3Parser::finish(Batch& into) {
    const bool inside = state_ == State::records || state_ == State::passing_over;
    if (inside || (state_ == State::header && !unit_.empty()))
        damage_.count(DamageReason::truncated);
    validator_.finish(into, damage_);
    if (const auto newest = validator_.newest_us()) move_clock(*newest);
    unit_.clear();
    state_ = State::header;
}

void Aedat3Parser::resync() {
    unit_.clear();
    state_ = State::searching;
    was_reset_ = is_joined_ = false;
    newest_us_.reset();
    validator_.resync(damage_);
}

std::optional<SensorTime> Aedat3Parser::clock() const {
    return newest_us_ ? std::optional(from_us(*newest_us_)) : std::nullopt;
}

}  // namespace eventide
