// Event packets of ROS drivers, written word by word.
#pragma once

#include "src/codec/event_packet.h"
#include "src/core/byte_order.h"
#include "tests/codec/parser_checks.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace eventide::event_packets {

constexpr int kWidth = 640, kHeight = 480;
constexpr std::int64_t kStamp = 1'700'000'000'000'000'000;  // ns
constexpr std::int64_t kStampUs = kStamp / 1000;

using Words = std::vector<std::uint16_t>;

inline Bytes bytes_of(const Words& words) {
    Bytes bytes;
    for (const std::uint16_t word : words) append_little(bytes, word);
    return bytes;
}

inline Bytes packet(const EventPacketHeader& header, const Bytes& payload) {
    Bytes bytes;
    append_event_packet(header, payload, bytes);
    return bytes;
}

inline Bytes operator+(Bytes a, const Bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

inline Event at(std::int64_t us, int x, int y, bool on) {
    return {from_us(us), std::uint16_t(x), std::uint16_t(y), Polarity(on)};
}

inline MakeParser parser_of(EventPacketEncoding encoding) {
    return [encoding] { return std::make_unique<EventPacketParser>(encoding, kWidth, kHeight); };
}

// libcaer_cmp
inline std::uint16_t high(unsigned n) {
    return std::uint16_t(0x0000 | n);
}
inline std::uint16_t low(unsigned us) {
    return std::uint16_t(0x1000 | us);
}
inline std::uint16_t column(unsigned x) {
    return std::uint16_t(0x2000 | x);
}
inline std::uint16_t row(unsigned y, bool on) {
    return std::uint16_t(0x3000 | y | (on ? 0x800 : 0));
}
inline std::uint16_t base(unsigned y, bool on) {
    return std::uint16_t(0x4000 | y | (on ? 0x800 : 0));
}
inline std::uint16_t mask(unsigned bits) {
    return std::uint16_t(0x5000 | bits);
}

inline Bytes libcaer_event(unsigned x, unsigned y, bool on, std::int32_t us, bool valid = true) {
    Bytes bytes;
    append_little(bytes, std::uint32_t(x << 17 | y << 2 | unsigned(on) << 1 | unsigned(valid)));
    append_little(bytes, us);
    return bytes;
}

inline Bytes mono_event(unsigned x, unsigned y, bool on, std::uint32_t ns) {
    Bytes bytes;
    append_little(bytes,
                  ns | std::uint64_t{x} << 32 | std::uint64_t{y} << 48 | std::uint64_t{on} << 63);
    return bytes;
}

// EVT3
inline std::uint16_t evt_high(unsigned n) {
    return std::uint16_t(0x8000 | n);
}
inline std::uint16_t evt_low(unsigned us) {
    return std::uint16_t(0x6000 | us);
}
inline std::uint16_t evt_row(unsigned y) {
    return std::uint16_t(y);
}
inline std::uint16_t evt_x(unsigned x, bool on) {
    return std::uint16_t(0x2000 | x | (on ? 0x800 : 0));
}

}  // namespace eventide::event_packets
