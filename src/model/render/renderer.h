// The implicit decoder: latent maps in, a frame of any time and any size out.
#pragma once

#include "src/core/frame_data.h"
#include "src/model/engine.h"
#include "src/model/latent_window.h"
#include "src/model/model_file.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

struct CodeChoice;
struct FrameGeometry;
class RendererCore;

struct RenderRequest {
    SensorTime t{};
    int width = 0, height = 0;              ///< px, of the whole output frame; 0: the sensor's
    Region region{};                        ///< the part of it that is wanted
    int lookahead = 0;                      ///< 0 to 2 event windows
    std::optional<SigmaRule> sigma_rule{};  ///< else the model's own
    bool want_sigma = true;
};

/// What a request asks for, with the sensor's size where it names none; not checked.
FrameGeometry geometry_of(const RenderRequest& request, int sensor_width, int sensor_height);

/// One thread at a time. Nothing fails after construction; with Engine::fast nothing is allocated
/// after make_output(), as long as frames come in the size it gave.
class Renderer {
public:
    /// Throws Error where the model does not hold together or the precision is not there.
    Renderer(const Model& model, int sensor_width, int sensor_height,
             const EngineOptions& options = {});
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    std::string description() const;
    /// Whether frames stay as they are while no events come; those of the thesis' network do not.
    bool rests_in_silence() const { return config_.encoder == EncoderKind::gated; }

    /// The latent map of the next event window; it is copied. Every frame wanted of event windows
    /// that only LatentWindow::kLatentsKept kept must be rendered before.
    void push(const LatentMap& latent) noexcept;
    /// The same without a copy where that can be: takes the codes out of `latent` and leaves those
    /// of an earlier map, for the encoder to write over.
    void take(LatentMap& latent) noexcept;
    /// The stream has ended: what is left is rendered at the live edge.
    void finish() noexcept;
    /// Back to the state after construction: a new stream, a jump in time.
    void reset() noexcept;

    Readiness readiness(SensorTime t, int lookahead) const noexcept;
    /// The earliest time that is not gone.
    SensorTime oldest() const noexcept { return window_.oldest(); }
    bool ready(SensorTime t, int lookahead) const noexcept {
        return readiness(t, lookahead) == Readiness::ready;
    }

    /// Gives `frame` the size the request asks for, and takes all the memory that rendering it
    /// needs, but what is there since one of the two sizes asked for last. Throws Error(usage)
    /// where the size, region or lookahead is impossible: a request that passes here is safe in
    /// render().
    void make_room(const RenderRequest& request, Frame& frame);
    /// The same with a new frame.
    Frame make_output(const RenderRequest& request);
    /// Only where ready(request.t, request.lookahead). `index` is 0; intensity is
    /// [y][x] of the region. Resizes the frame where it does not fit.
    void render(const RenderRequest& request, Frame& frame) noexcept;

    /// Since construction, with Engine::fast: pixels that were computed and not copied from a frame
    /// before.
    std::uint64_t pixels_rendered() const noexcept;

private:
    /// The mean of the ensemble's views, in `frame`, which has the right size.
    void render_views(const CodeChoice& codes, const FrameGeometry& geometry, SigmaRule rule,
                      Frame& frame) noexcept;

    ModelConfig config_;
    int sensor_width_, sensor_height_;
    LatentWindow window_;
    // One for each view of the ensemble (kMirrors).
    std::vector<std::unique_ptr<RendererCore>> cores_;
    Frame view_;  // what one of them gives
};

}  // namespace eventide
