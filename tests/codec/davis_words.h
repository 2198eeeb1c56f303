// DAVIS words, spelled out, and what a parser makes of them.
#pragma once

#include "src/codec/inivation/davis.h"
#include "tests/support/usb/davis_sensors.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace eventide::davis_words {

using testing_support::davis240;

// The vocabulary of docs/protocols.md A.9.
constexpr std::uint16_t time(int low15) {
    return std::uint16_t(0x8000 | low15);
}
constexpr std::uint16_t special(int what) {
    return std::uint16_t(what);
}
constexpr std::uint16_t addr_y(int y) {
    return std::uint16_t(0x1000 | y);
}
constexpr std::uint16_t off_x(int x) {
    return std::uint16_t(0x2000 | x);
}
constexpr std::uint16_t on_x(int x) {
    return std::uint16_t(0x3000 | x);
}
constexpr std::uint16_t adc(int level) {
    return std::uint16_t(0x4000 | level);
}
constexpr std::uint16_t imu_byte(int value) {
    return std::uint16_t(0x5000 | value);
}
constexpr std::uint16_t roi_high(int value) {
    return std::uint16_t(0x5100 | value);
}
constexpr std::uint16_t roi_low(int value) {
    return std::uint16_t(0x5200 | value);
}
constexpr std::uint16_t imu_scale(int bits) {
    return std::uint16_t(0x5300 | bits);
}
constexpr std::uint16_t exposure(int bits) {
    return std::uint16_t(0x6000 | bits);
}
constexpr std::uint16_t wrap(int times) {
    return std::uint16_t(0x7000 | times);
}
constexpr int kTimestampReset = 1, kImuStart = 5, kImuEnd = 7, kGlobalFrame = 8, kFrameEnd = 10,
              kResetColumn = 11, kSignalColumn = 12, kColumnEnd = 13, kExposureStart = 14,
              kExposureEnd = 15;

using Words = std::vector<std::uint16_t>;

inline std::vector<std::byte> bytes_of(const Words& words) {
    std::vector<std::byte> bytes;
    for (const std::uint16_t w : words) {
        bytes.push_back(std::byte(w & 0xFF));
        bytes.push_back(std::byte(w >> 8));
    }
    return bytes;
}

struct Parsed {
    Batch data;
    Damage damaged;
};

inline Parsed parse_bytes(std::span<const std::byte> bytes, const DavisSensor& sensor,
                          std::size_t piece = SIZE_MAX) {
    DavisParser parser{sensor};
    Parsed parsed;
    for (std::size_t at = 0; at < bytes.size(); at += std::min(piece, bytes.size() - at))
        parser.parse(bytes.subspan(at, std::min(piece, bytes.size() - at)), parsed.data);
    parser.finish(parsed.data);
    parsed.damaged = parser.damaged();
    return parsed;
}
inline Parsed parse(const Words& words, const DavisSensor& sensor = davis240()) {
    return parse_bytes(bytes_of(words), sensor);
}

/// What comes of words that a loss cuts off behind the first `n`, and then a reset of the camera's
/// clock.
inline Batch parse_cut_off(const Words& words, std::size_t n) {
    const std::vector<std::byte> bytes = bytes_of(words);
    const auto [first, rest] =
        std::pair{std::span{bytes}.first(2 * n), std::span{bytes}.subspan(2 * n)};
    DavisParser parser{davis240()};
    Batch data;
    parser.parse(first, data);
    parser.resync();
    parser.parse(rest, data);
    parser.parse(first, data);
    parser.parse(bytes_of({special(kTimestampReset)}), data);
    parser.parse(rest, data);
    return data;
}

inline Event event(std::int64_t t, int x, int y, Polarity polarity) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), polarity};
}

inline std::uint16_t wide(int ten_bits) {
    return std::uint16_t((ten_bits << 6) | (ten_bits >> 4));
}

}  // namespace eventide::davis_words
