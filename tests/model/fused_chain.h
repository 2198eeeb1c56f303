// The whole way from grids to frames that images correct.
#pragma once

#include "src/model/encode/encoder.h"
#include "src/model/render/fused_renderer.h"
#include "tests/model/fusion_images.h"
#include "tests/model/streams.h"
#include "tests/support/random_model.h"

namespace eventide::test {

/// Encoder, renderer and what corrects it, of a small network and a stream of events.
struct FusedChain {
    explicit FusedChain(int windows, const ModelConfig& of = small_config())
        : lookahead{windows}, config{of}, fused{renderer, kWidth, kHeight, windows} {
        fused.prepare({.lookahead = lookahead});
    }

    Window encode_next(GridStream::Kind kind) {
        const VoxelGrid& grid = stream.next(kind);
        encoder.encode(grid, latent);
        return latent.window = grid.window;
    }
    void push(float events_per_pixel) {
        renderer.push(latent);
        fused.push(latent.window, constant(events_per_pixel));
    }

    /// Its clock and all memory.
    void begin_anew() {
        encoder.reset();
        renderer.reset();
        fused.reset();
        stream = GridStream{config, kHeight, kWidth, 4};
    }
    Frame shown(RenderRequest request) {
        request.lookahead = lookahead;
        fused.prepare(request);
        Frame frame = renderer.make_output(request);
        fused.render(request, frame);
        return frame;
    }
    Frame shown(SensorTime t) { return shown(RenderRequest{.t = t}); }

    const int lookahead;
    const ModelConfig config;
    const Model model = random_model(config, 1);
    Encoder encoder{model, kWidth, kHeight};
    Renderer renderer{model, kWidth, kHeight};
    FusedRenderer fused;
    GridStream stream{config, kHeight, kWidth, 4};
    LatentMap latent = encoder.make_output();
};

}  // namespace eventide::test
