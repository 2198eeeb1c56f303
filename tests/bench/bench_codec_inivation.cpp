// Events per second of the text and AEDAT parsers, from memory, on one core.
#include "src/codec/aedat/aedat2.h"
#include "src/codec/aedat/aedat3.h"
#include "src/codec/text/text.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>

namespace eventide {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr std::size_t kEvents = 1'000'000;
constexpr std::size_t kChunkBytes = std::size_t(128) << 10;

Batch random_batch() {
    std::mt19937 random(1);
    Batch batch;
    std::int64_t t = 12'000'000;
    for (std::size_t i = 0; i < kEvents; ++i) {
        t += random() % 3;
        batch.events.push_back({from_us(t), std::uint16_t(random() % kWidth),
                                std::uint16_t(random() % kHeight), Polarity(random() % 2)});
    }
    return batch;
}

template <typename Writer>
std::vector<std::byte> written() {
    std::vector<std::byte> bytes;
    Writer().write(random_batch(), bytes);
    return bytes;
}

template <typename MakeParser>
void parse(benchmark::State& state, std::span<const std::byte> bytes, MakeParser make) {
    Batch batch;
    for (auto _ : state) {
        auto parser = make();
        std::size_t events = 0;
        for (std::size_t begin = 0; begin < bytes.size(); begin += kChunkBytes) {
            batch.clear();
            parser.parse(bytes.subspan(begin, std::min(kChunkBytes, bytes.size() - begin)), batch);
            events += batch.events.size();
        }
        if (events != kEvents) state.SkipWithError("events are missing");
    }
    state.SetItemsProcessed(std::int64_t(state.iterations() * kEvents));
    state.SetBytesProcessed(std::int64_t(state.iterations() * bytes.size()));
}

void text_seconds(benchmark::State& state) {
    parse(state, written<TextWriter>(), [] { return TextParser(TextLayout{}, kWidth, kHeight); });
}
BENCHMARK(text_seconds);

void aedat3_polarity(benchmark::State& state) {
    parse(state, written<Aedat3Writer>(),
          [] { return Aedat3Parser(Aedat3Header{}, kWidth, kHeight); });
}
BENCHMARK(aedat3_polarity);

void aedat2_dvs128(benchmark::State& state) {
    std::vector<std::byte> bytes;
    const auto append_big = [&](std::uint32_t value) {
        for (int i = 3; i >= 0; --i) bytes.push_back(std::byte(value >> (8 * i) & 0xFF));
    };
    for (const Event& event : random_batch().events) {
        append_big(std::uint32_t(event.y & 127) << 8 | std::uint32_t(event.x & 127) << 1 |
                   std::uint32_t(event.polarity));
        append_big(std::uint32_t(to_us(event.t)));
    }
    parse(state, bytes, [] { return Aedat2Parser(Aedat2Sensor::dvs128, 128, 128); });
}
BENCHMARK(aedat2_dvs128);

template <typename Writer>
void write(benchmark::State& state) {
    const Batch batch = random_batch();
    std::vector<std::byte> bytes;
    for (auto _ : state) {
        bytes.clear();
        Writer().write(batch, bytes);
    }
    state.SetItemsProcessed(std::int64_t(state.iterations() * kEvents));
}
BENCHMARK(write<TextWriter>);
BENCHMARK(write<Aedat3Writer>);

}  // namespace
}  // namespace eventide
