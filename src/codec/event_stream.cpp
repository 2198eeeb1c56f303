// Event Stream 2, byte by byte.
#include "src/codec/event_stream.h"

#include "src/core/byte_order.h"
#include "src/core/error.h"

#include <algorithm>
#include <cstring>
#include <string_view>

namespace eventide {

namespace {

// Name, three bytes of version, kind, width, height.
constexpr std::string_view kMagic = "Event Stream";
constexpr std::size_t kVersionAt = 12, kKindAt = 15, kSizeAt = 16, kHeaderBytes = 20;
constexpr std::array kKindNames{"generic events", "DVS events", "ATIS events", "display events",
                                "colour events"};

}  // namespace

bool is_event_stream(std::span<const std::byte> first_bytes) {
    return first_bytes.size() >= kMagic.size() &&
           std::memcmp(first_bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

EventStreamHeader read_event_stream_header(std::span<const std::byte> first_bytes) {
    const auto refuse = [](const std::string& what) {
        throw Error(ErrorKind::input,
                    "expected an Event Stream 2 of DVS or ATIS events, found " + what);
    };
    if (!is_event_stream(first_bytes)) refuse("something else");
    if (first_bytes.size() < kHeaderBytes) refuse("a header cut short");
    const auto byte = [&](std::size_t at) { return std::to_integer<unsigned>(first_bytes[at]); };
    if (byte(kVersionAt) != 2)
        refuse("version " + std::to_string(byte(kVersionAt)) + "." +
               std::to_string(byte(kVersionAt + 1)));
    const unsigned kind = byte(kKindAt);
    if (kind != 1 && kind != 2)
        refuse(kind < kKindNames.size() ? kKindNames[kind] : "kind " + std::to_string(kind));
    EventStreamHeader header;
    header.kind = kind == 1 ? EventStreamHeader::Kind::dvs : EventStreamHeader::Kind::atis;
    header.stream.format = "es";
    header.stream.width = load_little<std::uint16_t>(first_bytes.data() + kSizeAt);
    header.stream.height = load_little<std::uint16_t>(first_bytes.data() + kSizeAt + 2);
    header.stream.data_offset = kHeaderBytes;
    return header;
}

EventStreamParser::EventStreamParser(EventStreamHeader::Kind kind, int width, int height)
    : kind_(kind), height_(height), validator_(std::uint64_t(width), std::uint64_t(height)) {}

void EventStreamParser::parse(std::span<const std::byte> bytes, Batch& into) {
    for (const std::byte each : bytes) {
        const auto byte = std::to_integer<unsigned>(each);
        if (n_ == 0) {
            take_first(byte);
        } else {
            bytes_[n_++] = byte;
            if (n_ == bytes_.size()) take_event(into);
        }
    }
    started_ = started_ || !bytes.empty();
}

/// DVS: seven bits of time and the polarity; 0xFF lets 127 us pass, 0xFE means nothing. ATIS: six
/// bits of time and two of kind; 0xFC to 0xFF let 0 to 3 times 63 us pass.
void EventStreamParser::take_first(unsigned byte) {
    if (kind_ == EventStreamHeader::Kind::dvs) {
        if (byte == 0xFF) t_us_ += 0x7F;
        if (byte >= 0xFE) return;
        t_us_ += byte >> 1;
    } else {
        if (byte >= 0xFC) {
            t_us_ += 0x3F * (byte & 3);
            return;
        }
        t_us_ += byte >> 2;
    }
    bytes_[0] = byte;
    n_ = 1;
}

void EventStreamParser::take_event(Batch& into) {
    n_ = 0;
    const bool dvs = kind_ == EventStreamHeader::Kind::dvs;
    if (!dvs && (bytes_[0] & 1) != 0) return;  // exposure begins or ends
    const bool on = dvs ? (bytes_[0] & 1) != 0 : (bytes_[0] & 2) != 0;
    const unsigned x = bytes_[1] | bytes_[2] << 8, y = bytes_[3] | bytes_[4] << 8;
    const std::int64_t row = std::int64_t{height_} - 1 - y;
    if (row < 0) return damage_.count(DamageReason::out_of_range);
    validator_.add(t_us_, x, std::uint64_t(row), on, into, damage_);
}

void EventStreamParser::finish(Batch& into) {
    if (n_ > 0) damage_.count(DamageReason::truncated);
    n_ = 0;
    validator_.finish(into, damage_);
}

void EventStreamParser::resync() {
    n_ = 0;
    validator_.resync(damage_);
}

std::optional<SensorTime> EventStreamParser::clock() const {
    if (!started_) return std::nullopt;
    return from_us(t_us_);
}

}  // namespace eventide
