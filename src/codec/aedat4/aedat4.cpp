// Finds the packets of AEDAT4 in a stream cut anywhere, whole or damaged.
#include "src/codec/aedat4/aedat4.h"

#include "src/core/byte_order.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <span>

namespace eventide {

namespace {

constexpr std::size_t kPacketHeaderBytes = 8;  // i32 stream, i32 bytes
// Enough to tell whether a packet begins here: its header, and of a bare payload the size, the
// root's offset and the identifier.
constexpr std::size_t kLookBytes = kPacketHeaderBytes + 12;
constexpr std::size_t kSmallestPayload = 12;
// Damage can look like the beginning of many packets, each inside the one before: after so many
// that were none, whole ones are passed over, so that no byte is unpacked without end.
constexpr int kMaxFailuresInside = 16;

bool is_identifier(const std::byte* four) {
    return std::all_of(four, four + 4, [](std::byte b) {
        return (b >= std::byte{'A'} && b <= std::byte{'Z'}) ||
               (b >= std::byte{'0'} && b <= std::byte{'9'});
    });
}

/// Without a size every 15-bit coordinate is inside.
std::uint64_t side(int px) {
    return px > 0 ? std::uint64_t(px) : 32768;
}

}  // namespace

Aedat4Parser::Aedat4Parser(const Aedat4Header& header, int width, int height, std::size_t largest)
    : header_(header),
      validator_(side(width), side(height), EventValidator::LeapEnds::with_next_packet),
      unpacker_(largest),
      chosen_(header.chosen),
      all_streams_(header.streams.empty()),
      position_(header.stream.data_offset) {
    if (header_.table_position <= 0) damage_.count(DamageReason::bad_table);
}

void Aedat4Parser::parse(std::span<const std::byte> bytes, Batch& into) {
    while (!pending_.empty() && !bytes.empty()) {
        const std::size_t wanted = need_ > pending_.size() ? need_ - pending_.size() : 0;
        const std::size_t n = std::min(wanted + kLookBytes, bytes.size());
        pending_.insert(pending_.end(), bytes.begin(), bytes.begin() + std::ptrdiff_t(n));
        std::span<const std::byte> rest(pending_);
        if (pending_.size() >= need_) run(rest, into);
        if (rest.size() <= n) {  // all of it lies in `bytes`, too, where a search goes on quickly
            bytes = bytes.subspan(n - rest.size());
            pending_.clear();
            break;
        }
        bytes = bytes.subspan(n);
        pending_.erase(pending_.begin(), pending_.end() - std::ptrdiff_t(rest.size()));
    }
    if (bytes.empty()) return;
    run(bytes, into);
    pending_.assign(bytes.begin(), bytes.end());
}

/// Steps until more bytes are needed.
void Aedat4Parser::run(std::span<const std::byte>& bytes, Batch& into) {
    while (!bytes.empty()) {
        const std::size_t n = step(bytes, into);
        if (n == 0) return;
        bytes = bytes.subspan(n);
        if (position_) *position_ += n;
    }
}

std::size_t Aedat4Parser::step(std::span<const std::byte> bytes, Batch& into) {
    if (state_ == State::table) return read_table(bytes);
    if (bytes.size() < kLookBytes) {
        need_ = kLookBytes;
        return 0;
    }
    if (may_be_table(bytes, 0)) {
        const bool fits = !position_ || header_.table_position <= 0 ||
                          *position_ == std::uint64_t(header_.table_position);
        if (!fits) damage_.count(DamageReason::bad_table);
        state_ = State::table;
        return read_table(bytes);
    }
    if (may_be_packet(bytes)) return read_packet(bytes, into);
    if (state_ == State::searching) return search(bytes);
    damage_.count(DamageReason::unknown_word);
    state_ = State::searching;
    missed_packets_ = true;
    return 1;
}

/// Bytes before the next place where a packet may begin.
std::size_t Aedat4Parser::search(std::span<const std::byte> bytes) {
    std::size_t at = 1;
    while (at + kLookBytes <= bytes.size() && !may_be_packet(bytes.subspan(at)) &&
           !may_be_table(bytes, at))
        ++at;
    return at;
}

bool Aedat4Parser::may_be_packet(std::span<const std::byte> bytes) const {
    const auto stream = load_little<std::int32_t>(bytes.data());
    const auto size = load_little<std::int32_t>(bytes.data() + 4);
    if (size < std::int32_t(kSmallestPayload) || std::size_t(size) > kLargestAedat4Packet)
        return false;
    if (all_streams_ ? stream < 0 || stream > 255
                     : std::none_of(header_.streams.begin(), header_.streams.end(),
                                    [&](const Aedat4Stream& s) { return s.id == stream; }))
        return false;
    const auto payload = bytes.subspan(kPacketHeaderBytes);
    if (is_lz4_frame(payload) || is_zstd_frame(payload)) return true;
    return std::int64_t(load_little<std::uint32_t>(payload.data())) == std::int64_t(size) - 4 &&
           is_identifier(payload.data() + 8);
}

/// A table stands where a packet would, without a packet's header.
bool Aedat4Parser::may_be_table(std::span<const std::byte> bytes, std::size_t at) const {
    if (state_ == State::searching) {
        // Packed payloads begin in the same way; only the header tells where the table is.
        return position_ && header_.table_position > 0 &&
               *position_ + at == std::uint64_t(header_.table_position);
    }
    return is_lz4_frame(bytes) || is_zstd_frame(bytes) ||
           std::memcmp(bytes.data() + 8, "FTAB", 4) == 0;
}

std::size_t Aedat4Parser::read_packet(std::span<const std::byte> bytes, Batch& into) {
    const auto stream = load_little<std::int32_t>(bytes.data());
    const auto size = load_little<std::int32_t>(bytes.data() + 4);
    const std::size_t whole = kPacketHeaderBytes + std::size_t(size);
    if (bytes.size() < whole) {
        need_ = whole;
        return 0;
    }
    const Damage before = damage_;
    if (!take_payload(stream, bytes.subspan(kPacketHeaderBytes, std::size_t(size)), into)) {
        const bool counted = !(before == damage_);
        return drop_packet(whole, counted ? DamageReason::kCount : DamageReason::bad_compression);
    }
    failed_in_a_row_ = 0;
    state_ = State::packets;
    trace_.add(stream, size);
    return whole;
}

/// Goes on behind the first byte, since the packet's own size may be the damage.
std::size_t Aedat4Parser::drop_packet(std::size_t bytes, DamageReason reason) {
    if (reason != DamageReason::kCount) damage_.count(reason);
    state_ = State::searching;
    missed_packets_ = true;
    return ++failed_in_a_row_ > kMaxFailuresInside ? bytes : 1;
}

/// False when the bytes are no packet; then nothing was taken.
bool Aedat4Parser::take_payload(std::int32_t stream, std::span<const std::byte> payload,
                                Batch& into) {
    if (!all_streams_ && std::find(chosen_.begin(), chosen_.end(), stream) == chosen_.end())
        return true;
    const auto unpacked = unpacker_.unpack(payload);
    if (!unpacked) return false;
    const auto root = read_flat_root(*unpacked);
    if (!root) {
        damage_.count(DamageReason::bad_record);
        return false;
    }
    const auto kind = kind_of(root->identifier);
    if (!kind) return true;
    auto& chosen = chosen_[std::size_t(*kind)];
    if (!chosen && all_streams_) chosen = stream;
    if (chosen == stream) take_root(*kind, root->table, into);
    return true;
}

/// Most cameras' time goes on where their clock is reset; a sender that began anew is in the past.
void Aedat4Parser::note_reset(const Trigger& trigger) {
    const auto newest = validator_.newest_us();
    if (trigger.kind == Trigger::Kind::timestamp_reset && newest && to_us(trigger.t) < *newest)
        anew_us_ = to_us(trigger.t);
}

void Aedat4Parser::take_root(Aedat4Kind kind, const FlatTable& table, Batch& into) {
    std::optional<std::int64_t> newest;
    switch (kind) {
        case Aedat4Kind::events: {
            const bool is_reset = anew_us_.has_value();
            newest = take_aedat4_events(table, validator_, anew_us_, into, damage_);
            if (is_reset && !anew_us_) told_ = {};
            if (newest) told_.tell_by_events(*newest);
            return;
        }
        case Aedat4Kind::image:
            newest = take_aedat4_image(table, validator_, into, damage_);
            break;
        case Aedat4Kind::imu:
            newest = take_aedat4_imu(table, into, damage_);
            break;
        case Aedat4Kind::triggers: {
            const std::size_t before = into.triggers.size();
            newest = take_aedat4_triggers(table, into, damage_);
            for (const Trigger& trigger : std::span(into.triggers).subspan(before))
                note_reset(trigger);
            break;
        }
    }
    if (newest) told_.tell(*newest);
    told_.end_packet();
}

/// All that comes belongs to the table.
std::size_t Aedat4Parser::read_table(std::span<const std::byte> bytes) {
    if (bytes.size() > kLargestAedat4Packet) return bytes.size();
    need_ = kLargestAedat4Packet + 1;
    return 0;
}

void Aedat4Parser::check_table() {
    const auto table = read_aedat4_table(pending_, unpacker_.largest());
    Aedat4PacketTrace told;
    if (table)
        for (const Aedat4TableEntry& entry : table->entries) told.add(entry.stream, entry.bytes);
    if (!table || (position_ && !missed_packets_ && !(told == trace_)))
        damage_.count(DamageReason::bad_table);
}

void Aedat4Parser::finish(Batch& into) {
    if (state_ == State::table) {
        check_table();
    } else if (!pending_.empty()) {
        damage_.count(DamageReason::truncated);
        position_.reset();
        // The packet that did not end may be damage that swallowed whole ones.
        std::span<const std::byte> rest(pending_);
        while (!rest.empty()) {
            state_ = State::searching;
            rest = rest.subspan(1);
            run(rest, into);
        }
    }
    validator_.finish(into, damage_);
    if (const auto newest = validator_.newest_us()) told_.tell_by_events(*newest);
    told_.finish();
    pending_.clear();
}

void Aedat4Parser::resync() {
    pending_.clear();
    need_ = 0;
    state_ = State::searching;
    failed_in_a_row_ = 0;
    position_.reset();
    validator_.resync(damage_);
    told_ = {};
    anew_us_.reset();
}

std::optional<SensorTime> Aedat4Parser::clock() const {
    const auto newest = told_.newest_us();
    return newest ? std::optional(from_us(*newest)) : std::nullopt;
}

}  // namespace eventide
