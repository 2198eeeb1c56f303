// DAVIS words to events, from memory, on one core.
#include "src/codec/inivation/davis.h"
#include "tests/support/usb/davis_writer.h"

#include <benchmark/benchmark.h>

#include <random>

namespace eventide {
namespace {

constexpr std::size_t kEvents = 1'000'000, kTransferBytes = std::size_t(64) << 10;

/// `per_row` events share a row and a time: 1 is a sparse scene, 8 a busy one.
std::vector<std::byte> words(int per_row) {
    const DavisSensor sensor;
    std::mt19937 random{1};
    Batch batch;
    std::int64_t t = 0;
    while (batch.events.size() < kEvents) {
        t += std::int64_t(random() % 3);
        const auto x = std::uint16_t(random() % 346);
        for (int i = 0; i < per_row; ++i)
            batch.events.push_back(
                {from_us(t), x, std::uint16_t(random() % 260), Polarity(random() % 2)});
    }
    std::vector<std::byte> bytes;
    testing_support::DavisWriter{sensor}.write(batch, bytes);
    return bytes;
}

void davis_words(benchmark::State& state) {
    const std::vector<std::byte> bytes = words(int(state.range(0)));
    Batch batch;
    std::size_t events = 0;
    for (auto _ : state) {
        DavisParser parser{DavisSensor{}};
        for (std::size_t at = 0; at < bytes.size(); at += kTransferBytes) {
            batch.clear();
            parser.parse(std::span{bytes}.subspan(at, std::min(kTransferBytes, bytes.size() - at)),
                         batch);
            events += batch.events.size();
        }
    }
    state.SetItemsProcessed(std::int64_t(events));
    state.SetBytesProcessed(std::int64_t(state.iterations() * bytes.size()));
}
BENCHMARK(davis_words)->ArgName("events_per_row")->Arg(1)->Arg(8);

}  // namespace
}  // namespace eventide
