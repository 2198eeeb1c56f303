// What a parser makes of EVT3 streams.
#pragma once

#include "src/codec/prophesee/evt3.h"
#include "src/core/byte_order.h"
#include "tests/codec/evt3_words.h"
#include "tests/codec/parser_checks.h"

#include <memory>
#include <vector>

namespace eventide::evt3 {

constexpr int kWidth = 1280, kHeight = 720;

inline Bytes to_stream(const Words& words) {
    Bytes out;
    for (const std::uint16_t w : words) append_little(out, w);
    return out;
}

inline const MakeParser kMake = [] { return std::make_unique<Evt3Parser>(kWidth, kHeight); };

inline Parsed parse(const Words& words) {
    return parse_whole(kMake, to_stream(words));
}

inline void expect_events(const Parsed& parsed, const std::vector<Event>& expected) {
    EXPECT_TRUE(parsed.data.events == expected) << parsed.data.events.size() << " events";
}

}  // namespace eventide::evt3
