// A model at work without threads: event windows go in, the images that were asked for come out.
#pragma once

#include "src/binning/binner.h"
#include "src/model/encode/encoder.h"
#include "src/model/render/fused_renderer.h"
#include "src/model/render/renderer.h"

#include <deque>
#include <functional>
#include <optional>

namespace eventide {

/// One image to be made, and what it should show.
struct Query {
    SensorTime t{};
    Region region{};            ///< part of the image; width 0: all of it
    int width = 0, height = 0;  ///< px, of the whole image; 0: the sensor's
    Array2<float> truth;        ///< [y][x] of the region
};

/// One sequence.
class ModelRun {
public:
    struct Options {
        int lookahead = 0;
        std::optional<SigmaRule> sigma_rule;
        EngineOptions engine;
        bool fuse_images = false;  ///< give() is going to be called
    };
    using Use = std::function<void(const Query&, const Frame&)>;

    /// Throws Error where the model cannot be used for this sensor. `use` gets each image in the
    /// order of time.
    ModelRun(const Model& model, int width, int height, const Options& options, Use use);

    /// Times must not decrease, and must not lie before event windows already pushed.
    void ask(Query query) { queries_.push_back(std::move(query)); }

    /// An image of the sensor that corrects what is rendered from its window on. Times must not
    /// decrease.
    void give(const ReferenceImage& image) { fused_->give(image); }

    /// Renders whatever this event window makes possible.
    void push(const EventWindow& event_window);

    /// No more event windows: renders what is left inside them at the live edge.
    void finish();

    /// Queries that lay before the first event window or after the last.
    int not_rendered() const { return not_rendered_; }

private:
    void render_what_is_ready();

    Options options_;
    Use use_;
    Binner binner_;
    Encoder encoder_;
    Renderer renderer_;
    VoxelGrid grid_;
    LatentMap latent_;
    Frame frame_;
    std::deque<Query> queries_;
    std::optional<FusedRenderer> fused_;  // none: images are not used
    Array2<float> events_;                // per pixel, of the newest event window
    int not_rendered_ = 0;
};

}  // namespace eventide
