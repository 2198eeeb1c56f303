// Words of USB cameras as bytes, and what a parser makes of them.
#pragma once

#include "src/codec/parser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace eventide::usb_words {

template <typename Word>
std::vector<std::byte> bytes_of(const std::vector<Word>& words) {
    std::vector<std::byte> bytes;
    for (const Word w : words)
        for (std::size_t i = 0; i < sizeof(Word); ++i)
            bytes.push_back(std::byte((w >> (8 * i)) & 0xFF));
    return bytes;
}

struct Parsed {
    Batch data;
    Damage damaged;
};

template <typename P>
Parsed parse(P parser, const std::vector<std::byte>& bytes, std::size_t piece = 3) {
    Parsed parsed;
    for (std::size_t at = 0; at < bytes.size(); at += piece)
        parser.parse(std::span{bytes}.subspan(at, std::min(piece, bytes.size() - at)), parsed.data);
    parser.finish(parsed.data);
    parsed.damaged = parser.damaged();
    return parsed;
}

inline Event event(std::int64_t t, int x, int y, Polarity polarity) {
    return {from_us(t), std::uint16_t(x), std::uint16_t(y), polarity};
}

/// Random bytes: the same events for any split, none before another.
template <typename P>
void expect_survives(P make) {
    std::mt19937 rng{7};
    for (int round = 0; round < 200; ++round) {
        std::vector<std::byte> bytes(1 + rng() % 3000);
        for (auto& b : bytes) b = std::byte(rng());
        const auto whole = parse(make(), bytes, bytes.size()),
                   split = parse(make(), bytes, 1 + rng() % 50);
        ASSERT_EQ(whole.data.events, split.data.events);
        for (std::size_t i = 1; i < whole.data.events.size(); ++i)
            ASSERT_LE(whole.data.events[i - 1].t, whole.data.events[i].t);
    }
}

}  // namespace eventide::usb_words
