// Events per second of the text and AEDAT parsers, from memory, on one core.
#include "src/codec/aedat/aedat2.h"
#include "src/codec/aedat/aedat3.h"
#include "src/codec/text/text.h"
#include "tests/bench/parse_bench.h"

#include <benchmark/benchmark.h>

namespace eventide::bench {
namespace {

template <typename Writer>
std::vector<std::byte> written() {
    std::vector<std::byte> bytes;
    Writer().write(noise(), bytes);
    return bytes;
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
    for (const Event& event : noise().events) {
        append_big(std::uint32_t(event.y & 127) << 8 | std::uint32_t(event.x & 127) << 1 |
                   std::uint32_t(event.polarity));
        append_big(std::uint32_t(to_us(event.t)));
    }
    parse(state, bytes, [] { return Aedat2Parser(Aedat2Sensor::dvs128, 128, 128); });
}
BENCHMARK(aedat2_dvs128);

template <typename Writer>
void write(benchmark::State& state) {
    const Batch batch = noise();
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
}  // namespace eventide::bench
