// EVT3 streams written word by word, and what a parser makes of them.
#pragma once

#include "src/codec/prophesee/evt3.h"
#include "src/core/byte_order.h"
#include "tests/codec/parser_checks.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace eventide::evt3 {

constexpr int kWidth = 1280, kHeight = 720;
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

inline Bytes to_stream(const Words& words) {
    Bytes out;
    for (const std::uint16_t w : words) append_little(out, w);
    return out;
}

inline const MakeParser kMake = [] { return std::make_unique<Evt3Parser>(kWidth, kHeight); };

inline Parsed parse(const Words& words) {
    return parse_whole(kMake, to_stream(words));
}

inline Event event(std::int64_t t, int x, int y, Polarity polarity = kOff) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), polarity};
}

inline void expect_events(const Parsed& parsed, const std::vector<Event>& expected) {
    EXPECT_TRUE(parsed.data.events == expected) << parsed.data.events.size() << " events";
}

}  // namespace eventide::evt3
