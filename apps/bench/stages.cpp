// See stages.h.
#include "apps/bench/stages.h"

#include "apps/bench/products.h"
#include "src/binning/binner.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/renderer.h"

#include <array>
#include <cmath>

namespace eventide::bench {
namespace {

constexpr SensorDuration kWindow{50'000};

Spread time_binning(int bins, const std::vector<SceneWindow>& windows, const StageSettings& s) {
    Binner binner{bins, s.height, s.width};
    VoxelGrid grid = binner.make_output();
    double events = 0;
    for (const SceneWindow& window : windows) events += double(window.events.size());
    const Spread ms = timed(s.repetitions, [&](int) {
                          for (const SceneWindow& window : windows)
                              binner.process(window.event_window(), grid);
                      }).cpu_ms;
    return {events / (1e3 * ms.median), events / (1e3 * ms.high), events / (1e3 * ms.low)};
}

/// The windows in turn, as an encoder takes them.
class Encoding {
public:
    Encoding(Encoder& encoder, const std::vector<SceneWindow>& windows, const StageSettings& s)
        : encoder_(encoder) {
        Binner binner{encoder.bins(), s.height, s.width};
        for (const SceneWindow& window : windows)
            binner.process(window.event_window(), grids_.emplace_back(binner.make_output()));
        for (LatentMap& latent : latents_) latent = encoder.make_output();
    }
    LatentMap& step(int i) {
        LatentMap& latent = latents_[std::size_t(i) % latents_.size()];
        encoder_.encode(grids_[std::size_t(i) % grids_.size()], latent);
        return latent;
    }

private:
    Encoder& encoder_;
    std::vector<VoxelGrid> grids_;
    std::array<LatentMap, 4> latents_;
};

/// A fresh frame of one event window after the other, each just encoded, and another of the same.
void time_rendering(Renderer& renderer, Encoding& encoding, const StageSettings& s, StageRow& row) {
    RenderRequest request;
    request.width = int(std::lround(s.width * s.scale));
    request.height = int(std::lround(s.height * s.scale));
    request.lookahead = s.lookahead;
    Frame frame = renderer.make_output(request);
    SensorTime end{};
    const auto next = [&](int i) -> LatentMap& {
        LatentMap& latent = encoding.step(i);
        latent.history = {};  // all of it is new
        latent.window = {end, end + kWindow};
        end += kWindow;
        return latent;
    };
    const auto render_at = [&](int thousandths) {
        request.t = end - kWindow * (s.lookahead + 1) + kWindow * thousandths / 1000;
        renderer.render(request, frame);
    };
    constexpr int kWarm = 6;  // all that a lookahead waits for, and all buffers
    Stopwatch fresh, again;
    for (int i = 0; i < kWarm; ++i) renderer.take(next(i)), render_at(500);
    for (int i = 0; i < s.repetitions; ++i) {
        LatentMap& latent = next(kWarm + i);
        fresh.start();
        renderer.take(latent);
        render_at(400);
        fresh.stop();
        again.start();
        render_at(700);
        again.stop();
    }
    row.fresh.time = fresh.timing();
    row.again.time = again.timing();
}

FrameGeometry frame_geometry_of(const StageSettings& s) {
    FrameGeometry geometry;
    geometry.sensor_width = s.width;
    geometry.sensor_height = s.height;
    geometry.width = geometry.part_width = int(std::lround(s.width * s.scale));
    geometry.height = geometry.part_height = int(std::lround(s.height * s.scale));
    return geometry;
}

}  // namespace

StageRow measure_stages(const std::string& name, const Model& model,
                        const std::vector<SceneWindow>& windows, const StageSettings& settings,
                        const Peaks& peaks) {
    StageSettings s = settings;
    s.engine.skip_quiet = false;
    Encoder encoder{model, s.width, s.height, s.engine};
    Renderer renderer{model, s.width, s.height, s.engine};
    StageRow row;
    row.model = name;
    row.engine = encoder.description();
    row.width = s.width;
    row.height = s.height;
    row.bf16 = row.engine.find("bf16") != std::string::npos;
    const bool by_amx = row.engine.find("AMX") != std::string::npos;
    row.peak_gflops = by_amx ? peaks.bf16_amx : row.bf16 ? peaks.bf16 : peaks.f32();
    row.bin_mev_s = time_binning(model.config.bins, windows, s);
    Encoding encoding{encoder, windows, s};
    row.encode.time = timed(s.repetitions, [&](int i) { encoding.step(i); });
    row.encode.products = encode_products(model.config, s.height, s.width);
    time_rendering(renderer, encoding, s, row);
    const RenderProducts products =
        render_products(model.config, frame_geometry_of(s), s.lookahead);
    row.fresh.products = products.first + products.end + products.frame;
    row.again.products = products.frame;
    return row;
}

}  // namespace eventide::bench
