// Events per second of the AEDAT4, EVT and DAT parsers, from memory, on one core. Real recordings
// are used where they are at hand (EVENTIDE_DATA names the folder that holds formats/).
#include "src/codec/aedat4/aedat4.h"
#include "src/codec/aedat4/aedat4_writer.h"
#include "src/codec/prophesee/dat.h"
#include "src/codec/prophesee/evt2.h"
#include "src/codec/prophesee/evt3.h"
#include "src/codec/prophesee/evt_header.h"
#include "src/core/byte_order.h"
#include "tests/bench/parse_bench.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

namespace eventide::bench {
namespace {

using Bytes = std::vector<std::byte>;
/// Moving edges and noise, read out row by row every 20 us, as sensors with an arbiter do.
Batch moving_edges() {
    std::mt19937 random(1);
    Batch batch;
    for (std::int64_t t = 12'000'000; batch.events.size() < kEvents; t += 20) {
        const int y = int(random() % kHeight);
        const auto polarity = Polarity(random() % 2);
        const int begin = int(t / 500 + y / 3) % kWidth;
        const int end = std::min(kWidth, begin + int(random() % 24));
        for (int x = begin; x < end; ++x)
            if (random() % 3 == 0)
                batch.events.push_back({from_us(t), std::uint16_t(x), std::uint16_t(y), polarity});
        batch.events.push_back({from_us(t), std::uint16_t(random() % kWidth),
                                std::uint16_t(random() % kHeight), Polarity(random() % 2)});
    }
    return batch;
}

Bytes read_real(const std::string& name) {
    const char* named = std::getenv("EVENTIDE_DATA");
    std::string path = named ? named : "../shared/data";
    path.append("/formats/").append(name);
    std::ifstream file(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    return {begin, begin + text.size()};
}

template <typename Writer>
Bytes written(Writer writer, const Batch& batch) {
    Bytes out;
    StreamHeader header;
    header.width = kWidth;
    header.height = kHeight;
    writer.begin(header, out);
    for (std::size_t begin = 0; begin < batch.events.size(); begin += 10'000) {
        Batch piece;
        piece.events.assign(
            batch.events.begin() + std::ptrdiff_t(begin),
            batch.events.begin() + std::ptrdiff_t(std::min(begin + 10'000, batch.events.size())));
        writer.write(piece, out);
    }
    writer.finish(out);
    for (const auto& patch : writer.patches())
        std::copy(patch.bytes.begin(), patch.bytes.end(),
                  out.begin() + std::ptrdiff_t(patch.offset));
    return out;
}

void aedat4(benchmark::State& state, const Bytes& file) {
    if (file.empty()) return state.SkipWithError("the recording is not at hand");
    Aedat4Header header = read_aedat4_header(file);
    for (const auto kind : {Aedat4Kind::image, Aedat4Kind::imu, Aedat4Kind::triggers})
        header.chosen[std::size_t(kind)].reset();
    parse(state, std::span(file).subspan(header.stream.data_offset),
          [&] { return Aedat4Parser(header, header.stream.width, header.stream.height); });
}

void evt3(benchmark::State& state, const Bytes& file) {
    if (file.empty()) return state.SkipWithError("the recording is not at hand");
    const StreamHeader header = read_evt_header(file).stream;
    parse(state, std::span(file).subspan(header.data_offset),
          [&] { return Evt3Parser(header.width, header.height); });
}

Bytes evt2_words(const Batch& batch) {
    Bytes out;
    std::int64_t high = -1;
    for (const Event& event : batch.events) {
        const std::int64_t t = to_us(event.t);
        if (t >> 6 != high) {
            high = t >> 6;
            append_little(out, std::uint32_t(0x80000000U | std::uint32_t(high)));
        }
        append_little(out, std::uint32_t(event.polarity) << 28 | std::uint32_t(t & 63) << 22 |
                               std::uint32_t(event.x) << 11 | event.y);
    }
    return out;
}

/// Words of up to 32 columns.
Bytes evt21_words(const Batch& batch) {
    Bytes out;
    std::int64_t high = -1;
    for (std::size_t i = 0; i < batch.events.size();) {
        const Event& first = batch.events[i];
        const std::int64_t t = to_us(first.t);
        if (t >> 6 != high) {
            high = t >> 6;
            append_little(out, std::uint32_t(0));
            append_little(out, std::uint32_t(0x80000000U | std::uint32_t(high)));
        }
        const std::uint32_t base = first.x & ~31U;
        std::uint32_t mask = 0;
        for (; i < batch.events.size(); ++i) {
            const Event& e = batch.events[i];
            const bool same = e.t == first.t && e.y == first.y && e.polarity == first.polarity &&
                              (e.x & ~31U) == base && (mask >> (e.x - base)) == 0;
            if (!same) break;
            mask |= 1U << (e.x - base);
        }
        append_little(out, mask);
        append_little(out, std::uint32_t(first.polarity) << 28 | std::uint32_t(t & 63) << 22 |
                               base << 11 | first.y);
    }
    return out;
}

Bytes dat_words(const Batch& batch) {
    Bytes out;
    for (const Event& event : batch.events) {
        append_little(out, std::uint32_t(to_us(event.t)));
        append_little(out,
                      std::uint32_t(event.polarity) << 28 | std::uint32_t(event.y) << 14 | event.x);
    }
    return out;
}

void aedat4_lz4_real(benchmark::State& state) {
    aedat4(state, read_real("davis346_robotarm.aedat4"));
}
void aedat4_lz4_edges(benchmark::State& state) {
    aedat4(state, written(Aedat4Writer(), moving_edges()));
}
void aedat4_lz4_noise(benchmark::State& state) {
    aedat4(state, written(Aedat4Writer(), noise()));
}
void aedat4_zstd_edges(benchmark::State& state) {
    aedat4(state, written(Aedat4Writer(Aedat4Compression::zstd), moving_edges()));
}
void aedat4_none_edges(benchmark::State& state) {
    aedat4(state, written(Aedat4Writer(Aedat4Compression::none), moving_edges()));
}
void evt3_real(benchmark::State& state) {
    evt3(state, read_real("evt3_1280x720_5000.raw"));
}
void evt3_edges(benchmark::State& state) {
    evt3(state, written(Evt3Writer(), moving_edges()));
}
void evt3_noise(benchmark::State& state) {
    evt3(state, written(Evt3Writer(), noise()));
}
void evt2_real(benchmark::State& state) {
    const Bytes file = read_real("evt2_640x480.raw");
    if (file.empty()) return state.SkipWithError("the recording is not at hand");
    parse(state, std::span(file).subspan(read_evt_header(file).stream.data_offset),
          [] { return Evt2Parser(kWidth, kHeight); });
}
void evt2_noise(benchmark::State& state) {
    parse(state, evt2_words(noise()), [] { return Evt2Parser(kWidth, kHeight); });
}
void evt21_edges(benchmark::State& state) {
    parse(state, evt21_words(moving_edges()), [] { return Evt21Parser(kWidth, kHeight); });
}
void dat_noise(benchmark::State& state) {
    parse(state, dat_words(noise()),
          [] { return DatParser(DatHeader::Record::events_v2, kWidth, kHeight); });
}
BENCHMARK(aedat4_lz4_real);
BENCHMARK(aedat4_lz4_edges);
BENCHMARK(aedat4_lz4_noise);
BENCHMARK(aedat4_zstd_edges);
BENCHMARK(aedat4_none_edges);
BENCHMARK(evt3_real);
BENCHMARK(evt3_edges);
BENCHMARK(evt3_noise);
BENCHMARK(evt2_real);
BENCHMARK(evt2_noise);
BENCHMARK(evt21_edges);
BENCHMARK(dat_noise);

}  // namespace
}  // namespace eventide::bench
