// Any bytes as what a run remembers: refused with an Error, or what is made of it does not fail.
// corpus/stream_state: what `eventide run --states-out` kept of a sensor of 10 x 9 with
// corpus/model/tiny, with and without `--noise-filter auto` and in flickering light.
#include "apps/cli/run/state/stream_state.h"
#include "src/binning/binner.h"
#include "src/core/error.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    constexpr int kWidth = 10, kHeight = 9;
    try {
        TensorFile file =
            parse_safetensors({reinterpret_cast<const std::byte*>(data), size}, "fuzz");
        const auto state = app::take_stream_state(file, "fuzz", kWidth, kHeight);
        if (!state) return 0;
        Slicer slicer{parse_window("auto"), kWidth, kHeight};
        slicer.restore(state->stream.slicer);
        Binner binner{2, kHeight, kWidth};
        binner.restore(state->stream.ages);
        std::vector<Event> events{{state->stream.t, 3, 4, Polarity::on},
                                  {state->stream.t + SensorDuration{300'000}, 4, 4, Polarity::on}};
        if (state->filters.flicker) {
            FlickerPairs flicker{kWidth, kHeight, SensorDuration{16'000}};
            flicker.restore(*state->filters.flicker);
            flicker.process(events);
            flicker.flush(events);
        }
        if (state->filters.noise) {
            NoiseFilter noise{kWidth, kHeight, {}};
            noise.restore(*state->filters.noise);
            noise.process(events);
        }
        slicer.push(events);
        slicer.finish();
        VoxelGrid grid = binner.make_output();
        int most = 100;
        for (EventWindow window; most-- > 0 && slicer.next(window);) binner.process(window, grid);
    } catch (const Error&) {
    }
    return 0;
}
