// Speed of the simulator, in million pixel-steps per second of one core: pixels times sub-frames,
// each with its light, its sensor and its events.
#include "src/simulate/presets.h"
#include "src/simulate/scene/textures.h"
#include "src/simulate/simulated_stream.h"

#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

namespace eventide {
namespace {

std::shared_ptr<const TextureLibrary> textures() {
    static const std::shared_ptr<const TextureLibrary> kTextures = procedural_textures(25);
    return kTextures;
}

/// Half a second of each of `kScenes` scenes, truth at the end of every 50 ms.
void run_preset(benchmark::State& state, const char* name) {
    constexpr std::uint64_t kScenes = 12;
    constexpr int kFrames = 10;
    const SimulationPreset& preset = simulation_preset(name);
    const int side = int(state.range(0));
    double pixel_steps = 0, events_made = 0, seconds = 0;
    std::uint64_t seed = 0;
    std::vector<Event> events;
    Array2<float> truth(side, side);
    for (auto _ : state) {
        state.PauseTiming();
        SimulatedStream stream{preset.scene, preset.sensor, textures(),
                               side,         side,          seed++ % kScenes};
        state.ResumeTiming();
        for (int frame = 1; frame <= kFrames; ++frame) {
            events.clear();
            stream.advance(from_us(frame * 50000), events);
            stream.truth(stream.now(), truth);
            events_made += double(events.size());
        }
        pixel_steps += double(stream.sub_frames()) * side * side;
        seconds += kFrames * .05;
    }
    const auto rate = [](double value) {
        return benchmark::Counter(value, benchmark::Counter::kIsRate);
    };
    state.counters["Mpixel_steps"] = rate(pixel_steps * 1e-6);
    state.counters["Mevents"] = rate(events_made * 1e-6);
    state.counters["times_real_time"] = rate(seconds);
}

// Twelve scenes are one whole round: fewer iterations would measure easy ones or hard ones only.
BENCHMARK_CAPTURE(run_preset, wide, "wide")->Arg(64)->Arg(128)->Iterations(24);
BENCHMARK_CAPTURE(run_preset, thesis, "thesis_train")->Arg(128)->Iterations(24);
BENCHMARK_CAPTURE(run_preset, demo, "demo")->Arg(180)->Iterations(24);

/// The truth alone, four times the sensor's size.
void enlarged_truth(benchmark::State& state) {
    const SimulationPreset& preset = simulation_preset("demo");
    SimulatedStream stream{preset.scene, preset.sensor, textures(), 128, 128, preset.seed};
    Array2<float> truth(512, 512);
    for (auto _ : state) stream.truth(stream.now(), truth);
    state.SetItemsProcessed(state.iterations() * 512 * 512);
}
BENCHMARK(enlarged_truth);

}  // namespace
}  // namespace eventide
