// What a fuzzer asks of every parser: no crash, orderly events, the same data for any split.
#pragma once

#include "src/codec/parser.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

namespace eventide {

inline void require(bool holds) {
    if (!holds) std::abort();
}

/// Parses in pieces whose sizes come from the bytes themselves (`salt` changes them).
inline Damage parse_for_fuzzer(Parser& parser, std::span<const std::byte> bytes, unsigned salt,
                               Batch& into) {
    std::size_t begin = 0;
    while (begin < bytes.size()) {
        const auto wish =
            salt == 0 ? bytes.size() : 1 + (std::size_t(bytes[begin]) * salt + begin) % 67;
        const std::size_t n = std::min(wish, bytes.size() - begin);
        const std::vector<std::byte> piece(bytes.begin() + std::ptrdiff_t(begin),
                                           bytes.begin() + std::ptrdiff_t(begin + n));
        parser.parse(piece, into);
        begin += n;
    }
    parser.finish(into);
    return parser.damaged();
}

/// Equal bit by bit: damaged bytes may make floats that are no numbers.
inline bool same_bits(const std::vector<ImuSample>& a, const std::vector<ImuSample>& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(ImuSample)) == 0);
}

/// What was whole before the jump comes out with the next call.
inline void jump(Parser& parser, Batch& batch) {
    parser.resync();
    parser.parse({}, batch);
    batch.clear();
}

/// Unless a clock that begins anew is told.
inline void require_order(const Batch& batch) {
    const auto is_reset = [](const Trigger& trigger) {
        return trigger.kind == Trigger::Kind::timestamp_reset;
    };
    if (std::ranges::any_of(batch.triggers, is_reset)) return;
    const std::vector<Event>& events = batch.events;
    for (std::size_t i = 1; i < events.size(); ++i) require(events[i].t >= events[i - 1].t);
}

template <typename MakeParser>
void fuzz_parser(std::span<const std::byte> bytes, int width, int height, MakeParser make) {
    Batch whole, split;
    const std::unique_ptr<Parser> first = make(), second = make();
    const Damage damage = parse_for_fuzzer(*first, bytes, 0, whole);
    for (const Event& event : whole.events) require(event.x < width && event.y < height);
    require_order(whole);
    require(parse_for_fuzzer(*second, bytes, 13, split) == damage);
    require(split.events == whole.events);
    require(split.images == whole.images);
    require(same_bits(split.imu, whole.imu));
    require(split.triggers == whole.triggers);
    require(first->clock() == second->clock());

    // After a jump the parser goes on, wherever that is and whatever the host's clock says; what
    // comes is in order until the next jump.
    for (std::size_t i = 0; i + 1 < bytes.size() && i < 8; ++i) {
        if (i % 3 == 0) jump(*second, split);
        second->arrives(HostTime{std::chrono::milliseconds{int(bytes[i]) * int(bytes[i + 1])}});
        second->parse(bytes.subspan(i, 1 + bytes.size() / 8), split);
        require_order(split);
    }
    jump(*second, split);
    parse_for_fuzzer(*second, bytes.subspan(bytes.size() / 3), 7, split);
    require_order(split);
}

}  // namespace eventide
