// EVT2 and EVT2.1 streams written word by word, and what a parser makes of them.
#pragma once

#include "src/codec/prophesee/evt2.h"
#include "src/core/byte_order.h"
#include "tests/codec/parser_checks.h"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace eventide::evt2 {

constexpr int kWidth = 640, kHeight = 480;
constexpr std::int64_t kHigh = 64;  // us
using Order = Evt21Parser::Order;
using Words = std::vector<std::uint32_t>;

inline std::uint32_t cd(unsigned t, unsigned x, unsigned y, bool on) {
    return std::uint32_t(on) << 28 | t << 22 | x << 11 | y;
}
inline std::uint32_t time_high(std::uint32_t t) {
    return 0x80000000U | t;
}
inline std::uint32_t ext_trigger(unsigned t, unsigned id, bool rising) {
    return 0xA0000000U | t << 22 | id << 8 | unsigned(rising);
}

inline Bytes to_stream(const Words& words) {
    Bytes out;
    for (const std::uint32_t w : words) append_little(out, w);
    return out;
}

/// EVT2.1: {upper half, lower half}
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
inline Bytes to_stream(const Pairs& words, Order order) {
    Bytes out;
    for (const auto& [upper, lower] : words) {
        append_little(out, order == Order::upper_half_first ? upper : lower);
        append_little(out, order == Order::upper_half_first ? lower : upper);
    }
    return out;
}

inline const MakeParser kMake2 = [] { return std::make_unique<Evt2Parser>(kWidth, kHeight); };
inline MakeParser make21(Order order) {
    return [order] { return std::make_unique<Evt21Parser>(kWidth, kHeight, order); };
}

inline Parsed parse(const Words& words) {
    return parse_whole(kMake2, to_stream(words));
}

inline Event event(std::int64_t t, int x, int y, bool on = false) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), Polarity(on)};
}

inline Words some_words(unsigned seed, std::size_t n) {
    std::mt19937 generator(seed);
    const auto random = [&] { return unsigned(generator()); };
    Words words;
    std::uint32_t t = 1000;
    while (words.size() < n) {
        t += 1 + random() % 3;
        words.push_back(time_high(t));
        unsigned low = 0;
        for (unsigned k = random() % 10; k > 0; --k)
            words.push_back(cd(low = std::min(63U, low + random() % 9), random() % kWidth,
                               random() % kHeight, random() % 2 == 1));
        if (random() % 9 == 0) words.push_back(ext_trigger(low, random() % 32, random() % 2 == 1));
    }
    return words;
}

}  // namespace eventide::evt2
