// Records of AEDAT 1 and 2, written as the format's description says.
#pragma once

#include "src/codec/aedat/aedat2.h"
#include "tests/codec/parser_checks.h"

#include <cstdint>
#include <vector>

namespace eventide::aedat2 {

constexpr int kWidth = 240, kHeight = 180;

inline Bytes big_endian(std::uint32_t value, int bytes) {
    Bytes out;
    for (int i = bytes - 1; i >= 0; --i) out.push_back(std::byte(value >> (8 * i) & 0xFF));
    return out;
}

inline Bytes record(std::uint32_t address, std::int64_t t) {
    Bytes out = big_endian(address, 4), time = big_endian(std::uint32_t(t), 4);
    out.insert(out.end(), time.begin(), time.end());
    return out;
}

/// x, y as in the image; the chip counts from the lower left, X mirrored.
inline Bytes dvs(int x, int y, bool on, std::int64_t t) {
    return record(std::uint32_t(kHeight - 1 - y) << 22 | std::uint32_t(kWidth - 1 - x) << 12 |
                      std::uint32_t(on) << 11,
                  t);
}
inline Bytes external(std::int64_t t) {
    return record(1U << 10, t);
}
inline Bytes aps(bool is_signal, int x, int y, int sample, std::int64_t t, int height = kHeight) {
    return record(1U << 31 | std::uint32_t(height - 1 - y) << 22 | std::uint32_t(x) << 12 |
                      std::uint32_t(is_signal) << 10 | std::uint32_t(sample),
                  t);
}
/// 10 bits, so that the largest is the largest of 16.
inline std::uint16_t of_16_bits(int ten_bits) {
    return std::uint16_t(ten_bits << 6 | ten_bits >> 4);
}
inline Bytes imu(unsigned measure, std::int16_t value, std::int64_t t) {
    return record(1U << 31 | measure << 28 | std::uint32_t(std::uint16_t(value)) << 12 | 3U << 10,
                  t);
}

inline Bytes join(const std::vector<Bytes>& parts) {
    Bytes all;
    for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

inline MakeParser davis(int width = kWidth, int height = kHeight) {
    return [=] { return std::make_unique<Aedat2Parser>(Aedat2Sensor::davis, width, height); };
}
inline MakeParser dvs128(bool one_is_on = false) {
    return
        [=] { return std::make_unique<Aedat2Parser>(Aedat2Sensor::dvs128, 128, 128, one_is_on); };
}

/// All resets, then all signals, as a global shutter reads.
inline Bytes global_frame(int x0, int y0, int width, int height, std::int64_t t) {
    Bytes all;
    for (const bool is_signal : {false, true})
        for (int x = x0; x < x0 + width; ++x)
            for (int y = y0; y < y0 + height; ++y) {
                const Bytes word = aps(is_signal, x, y, is_signal ? 500 - x - 10 * y : 600, t++, 4);
                all.insert(all.end(), word.begin(), word.end());
            }
    return all;
}

}  // namespace eventide::aedat2
