// What benchmarks of parsers share: events anywhere, and bytes in memory through a parser.
#pragma once

#include "src/codec/parser.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <span>

namespace eventide::bench {

constexpr int kWidth = 640, kHeight = 480;
constexpr std::size_t kEvents = 1'000'000;
constexpr std::size_t kChunkBytes = std::size_t(128) << 10;

/// Nothing to predict or to pack.
inline Batch noise() {
    std::mt19937 random(2);
    Batch batch;
    std::int64_t t = 12'000'000;
    for (std::size_t i = 0; i < kEvents; ++i) {
        t += random() % 3;
        batch.events.push_back({from_us(t), std::uint16_t(random() % kWidth),
                                std::uint16_t(random() % kHeight), Polarity(random() % 2)});
    }
    return batch;
}

/// `make` gives a parser, anew for each time through. Bytes that are missing or damaged are an
/// error.
template <typename MakeParser>
void parse(benchmark::State& state, std::span<const std::byte> bytes, const MakeParser& make) {
    if (bytes.empty()) {
        state.SkipWithError("the recording is not at hand");
        return;
    }
    Batch batch;
    std::size_t events = 0;
    for (auto _ : state) {
        auto parser = make();
        for (std::size_t begin = 0; begin < bytes.size(); begin += kChunkBytes) {
            batch.clear();
            parser.parse(bytes.subspan(begin, std::min(kChunkBytes, bytes.size() - begin)), batch);
            events += batch.events.size();
            benchmark::DoNotOptimize(batch.events.data());
        }
        parser.finish(batch);
        if (parser.damaged().total() != 0) state.SkipWithError("damage");
    }
    state.SetItemsProcessed(std::int64_t(events));
    state.SetBytesProcessed(state.iterations() * std::int64_t(bytes.size()));
}

}  // namespace eventide::bench
