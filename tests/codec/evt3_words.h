// EVT3 streams written word by word.
#pragma once

#include "src/core/event.h"

#include <cstdint>
#include <vector>

namespace eventide::evt3 {

constexpr auto kOn = Polarity::on, kOff = Polarity::off;
constexpr std::int64_t kHigh = 4096;  // us, a step of time_high

using Words = std::vector<std::uint16_t>;

inline std::uint16_t word(unsigned type, unsigned content) {
    return std::uint16_t(type << 12 | content);
}
inline std::uint16_t addr_y(unsigned y) {
    return word(0x0, y);
}
inline std::uint16_t addr_x(unsigned x, bool on = false) {
    return word(0x2, x | unsigned(on) << 11);
}
inline std::uint16_t vect_base_x(unsigned x, bool on = false) {
    return word(0x3, x | unsigned(on) << 11);
}
inline std::uint16_t vect_12(unsigned mask) {
    return word(0x4, mask);
}
inline std::uint16_t vect_8(unsigned mask) {
    return word(0x5, mask);
}
inline std::uint16_t time_low(unsigned t) {
    return word(0x6, t);
}
inline std::uint16_t time_high(unsigned t) {
    return word(0x8, t);
}
inline std::uint16_t ext_trigger(unsigned id, bool rising) {
    return word(0xA, id << 8 | unsigned(rising));
}

inline Event event(std::int64_t t, int x, int y, Polarity polarity = kOff) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), polarity};
}

}  // namespace eventide::evt3
