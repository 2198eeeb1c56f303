// What every parser must hold, whatever the format: any split, any truncation, any flipped bits.
#pragma once

#include "src/codec/parser.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

namespace eventide {

using Bytes = std::vector<std::byte>;
using MakeParser = std::function<std::unique_ptr<Parser>()>;

struct Parsed {
    Batch data;
    Damage damage;
    std::optional<SensorTime> clock;
};

inline Bytes to_bytes(std::string_view text) {
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    return {begin, begin + text.size()};
}

/// Parses pieces of sizes that next_size() gives.
inline Parsed parse_in_pieces(const MakeParser& make, std::span<const std::byte> bytes,
                              const std::function<std::size_t()>& next_size) {
    const auto parser = make();
    Parsed parsed;
    while (!bytes.empty()) {
        const std::size_t n = std::min(std::max<std::size_t>(next_size(), 1), bytes.size());
        // A copy of its own size, so that sanitizers see a read beyond the piece.
        const Bytes piece(bytes.begin(), bytes.begin() + std::ptrdiff_t(n));
        parser->parse(piece, parsed.data);
        bytes = bytes.subspan(n);
    }
    parser->finish(parsed.data);
    parsed.damage = parser->damaged();
    parsed.clock = parser->clock();
    return parsed;
}

inline Parsed parse_whole(const MakeParser& make, std::span<const std::byte> bytes) {
    return parse_in_pieces(make, bytes, [&] { return bytes.size(); });
}

inline void expect_same(const Parsed& a, const Parsed& b, const std::string& what) {
    EXPECT_TRUE(a.data.events == b.data.events)
        << what << ": " << a.data.events.size() << " and " << b.data.events.size() << " events";
    EXPECT_TRUE(a.data.images == b.data.images) << what;
    EXPECT_TRUE(a.data.imu == b.data.imu) << what;
    EXPECT_TRUE(a.data.triggers == b.data.triggers) << what;
    EXPECT_TRUE(a.damage == b.damage) << what;
    EXPECT_TRUE(a.clock == b.clock) << what;
}

/// The same bytes give the same data for any split.
inline void expect_same_for_any_split(const MakeParser& make, std::span<const std::byte> bytes) {
    const Parsed whole = parse_whole(make, bytes);
    for (const std::size_t size : {1U, 2U, 3U, 7U, 8U, 27U, 64U, 1000U})
        expect_same(whole, parse_in_pieces(make, bytes, [&] { return size; }),
                    "pieces of " + std::to_string(size));
    for (unsigned seed = 0; seed < 5; ++seed) {
        std::mt19937 random(seed);
        expect_same(whole, parse_in_pieces(make, bytes, [&] { return random() % 100; }),
                    "random pieces, seed " + std::to_string(seed));
    }
}

/// Events inside the sensor and in time order.
inline void expect_orderly(const Parsed& parsed, int width, int height) {
    const auto& events = parsed.data.events;
    EXPECT_TRUE(std::is_sorted(events.begin(), events.end(),
                               [](const Event& a, const Event& b) { return a.t < b.t; }));
    EXPECT_TRUE(std::all_of(events.begin(), events.end(),
                            [&](const Event& e) { return e.x < width && e.y < height; }));
}

/// A stream cut anywhere gives a beginning of the events of the whole one, or one event fewer or
/// more.
inline void expect_beginnings_for_any_cut(const MakeParser& make,
                                          std::span<const std::byte> bytes) {
    const auto whole = parse_whole(make, bytes).data.events;
    for (std::size_t n = 0; n < bytes.size(); ++n) {
        const auto part = parse_whole(make, bytes.first(n)).data.events;
        ASSERT_LE(part.size(), whole.size()) << "cut at " << n;
        // The last line of a text may be cut and still read as a row.
        const std::size_t sure = part.empty() ? 0 : part.size() - 1;
        ASSERT_TRUE(std::equal(part.begin(), part.begin() + std::ptrdiff_t(sure), whole.begin()))
            << "cut at " << n;
    }
}

/// Flipped bits and random bytes put in: no crash, still orderly, still the same for any split.
inline void expect_bears_damage(const MakeParser& make, const Bytes& bytes, int width, int height,
                                int rounds = 60) {
    for (int round = 0; round < rounds; ++round) {
        SCOPED_TRACE("seed " + std::to_string(round));
        std::mt19937 random{unsigned(round)};
        Bytes damaged = bytes;
        for (int flips = 1 + round % 8; flips > 0; --flips)
            damaged[random() % damaged.size()] ^= std::byte(1U << random() % 8);
        if (round % 3 == 1)
            damaged.erase(damaged.begin() + std::ptrdiff_t(random() % damaged.size()));
        if (round % 3 == 2)
            damaged.insert(damaged.begin() + std::ptrdiff_t(random() % damaged.size()),
                           std::byte(random() & 0xFF));
        const Parsed whole = parse_whole(make, damaged);
        expect_orderly(whole, width, height);
        expect_same(whole, parse_in_pieces(make, damaged, [&] { return random() % 50; }), "split");
    }
}

/// A flipped bit of a time costs at most `lost` of the events, and puts at most one elsewhere.
inline void expect_most_events_kept(const Parsed& parsed, const std::vector<Event>& events,
                                    std::size_t lost, const std::string& what) {
    std::size_t kept = 0;
    for (const Event& event : parsed.data.events)
        kept += std::size_t(std::count(events.begin(), events.end(), event));
    EXPECT_GE(kept + lost, events.size()) << what;
    EXPECT_LE(parsed.data.events.size(), kept + 1) << what;
}

/// Random events in time order.
inline std::vector<Event> random_events(unsigned seed, std::size_t n, int width, int height,
                                        std::int64_t first_us = 0, int most_step_us = 50) {
    std::mt19937 random(seed);
    std::vector<Event> events(n);
    std::int64_t t = first_us;
    for (Event& event : events) {
        t += std::int64_t(random() % unsigned(most_step_us + 1));
        event = {from_us(t), std::uint16_t(random() % unsigned(width)),
                 std::uint16_t(random() % unsigned(height)), Polarity(random() % 2 == 1)};
    }
    return events;
}

}  // namespace eventide
