// Speed of the filters that run by themselves, of slicing and binning on one core, whole-grid
// finalisation included.
#include "src/binning/binner.h"
#include "src/binning/flicker_pairs.h"
#include "src/binning/noise_filter.h"
#include "src/binning/slicer.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace {

using namespace eventide;

constexpr std::int64_t kWidthUs = 50'000;

/// Events as a camera gives them: three quarters along moving edges, the rest anywhere.
std::vector<Event> moving_edges(int width, int height, std::size_t n, std::int64_t begin_us) {
    std::mt19937 rng{7};
    std::vector<Event> events(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double phase = double(i) / double(n);
        Event& event = events[i];
        event.t = from_us(begin_us + 1 + std::int64_t(phase * double(kWidthUs - 1)));
        event.x = std::uint16_t(rng() % unsigned(width));
        event.y = std::uint16_t(rng() % unsigned(height));
        if (rng() % 4 != 0) {
            const double edge = width * (double(rng() % 8) / 8 + 0.05 * phase) + event.y * 0.3;
            event.x = std::uint16_t(std::fmod(edge + double(rng() % 3), width));
        }
        event.polarity = rng() % 2 == 0 ? Polarity::on : Polarity::off;
    }
    return events;
}

void bin(benchmark::State& state, int width, int height) {
    const int bins = int(state.range(0));
    const auto n = std::size_t(state.range(1));
    const auto events = moving_edges(width, height, n, 1'700'000'000'000'000);
    const EventWindow event_window{
        {from_us(1'700'000'000'000'000), from_us(1'700'000'000'000'000 + kWidthUs)}, events};
    Binner binner(bins, height, width);
    // As in the pipeline: a few grids in turn, so that the one written is not the one just read.
    std::vector<VoxelGrid> grids{binner.make_output(), binner.make_output(), binner.make_output()};
    std::size_t turn = 0;
    for (auto _ : state) {
        binner.process(event_window, grids[turn++ % grids.size()]);
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(n));
}

void BM_bin_240x180(benchmark::State& state) {
    bin(state, 240, 180);
}
void BM_bin_1280x720(benchmark::State& state) {
    bin(state, 1280, 720);
}
BENCHMARK(BM_bin_240x180)
    ->ArgsProduct({{2, 5}, {50'000, 200'000, 500'000, 2'000'000}})
    ->ArgNames({"B", "events"});
BENCHMARK(BM_bin_1280x720)
    ->ArgsProduct({{2, 5}, {2'000, 200'000, 2'000'000}})
    ->ArgNames({"B", "events"});

void event_window(benchmark::State& state, WindowRule rule) {
    const auto events = moving_edges(240, 180, 500'000, 0);
    constexpr std::size_t kPacket = 4096;  // events of one read
    SlicerSettings settings;
    settings.rule = rule;
    settings.width = SensorDuration{10'000};
    Slicer slicer(settings, 240, 180);
    for (auto _ : state) {
        slicer.reset();
        for (std::size_t i = 0; i < events.size(); i += kPacket) {
            slicer.push({events.data() + i, std::min(kPacket, events.size() - i)});
            for (EventWindow event_window; slicer.next(event_window);)
                benchmark::DoNotOptimize(event_window.events.size());
        }
    }
    state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(events.size()));
}
BENCHMARK_CAPTURE(event_window, duration, WindowRule::duration);
BENCHMARK_CAPTURE(event_window, count, WindowRule::count);

/// Of a filter that works in place, in the order it has in the pipeline.
template <typename Filter>
void filter(benchmark::State& state, int width, int height, Filter filter) {
    const auto n = std::size_t(state.range(0));
    std::vector<Event> events = moving_edges(width, height, n, 0), kept;
    for (auto _ : state) {
        state.PauseTiming();
        for (Event& event : events) event.t += SensorDuration{kWidthUs};
        kept = events;
        state.ResumeTiming();
        filter.process(kept);
        benchmark::DoNotOptimize(kept.size());
    }
    state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(n));
}

/// Where none flickers.
void lamp_flicker(benchmark::State& state, int width, int height) {
    filter(state, width, height, FlickerPairs(width, height, SensorDuration{0}));
}
BENCHMARK_CAPTURE(lamp_flicker, 240x180, 240, 180)->Arg(50'000)->ArgName("events");
BENCHMARK_CAPTURE(lamp_flicker, 640x480, 640, 480)->Arg(200'000)->ArgName("events");
BENCHMARK_CAPTURE(lamp_flicker, 1280x720, 1280, 720)->Arg(400'000)->ArgName("events");

void noise_filter(benchmark::State& state, int width, int height) {
    filter(state, width, height, NoiseFilter(width, height, {}));
}
BENCHMARK_CAPTURE(noise_filter, 240x180, 240, 180)->Arg(50'000)->ArgName("events");
BENCHMARK_CAPTURE(noise_filter, 640x480, 640, 480)->Arg(200'000)->ArgName("events");
BENCHMARK_CAPTURE(noise_filter, 1280x720, 1280, 720)->Arg(400'000)->ArgName("events");

}  // namespace
