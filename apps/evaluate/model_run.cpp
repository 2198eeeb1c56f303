// Bin, encode, render: the pipeline as three calls.
#include "apps/evaluate/model_run.h"

#include "src/binning/grid_sums.h"

namespace eventide {

ModelRun::ModelRun(const Model& model, int width, int height, const Options& options, Use use)
    : options_(options),
      use_(std::move(use)),
      binner_(model.config.bins, height, width),
      encoder_(model, width, height, options.engine),
      renderer_(model, width, height, options.engine),
      grid_(binner_.make_output()),
      latent_(encoder_.make_output()) {
    if (!options_.fuse_images) return;
    fused_.emplace(renderer_, width, height, options.lookahead);
    events_ = Array2<float>(height, width);
}

void ModelRun::push(const EventWindow& event_window) {
    binner_.process(event_window, grid_);
    encoder_.encode(grid_, latent_);
    renderer_.take(latent_);
    if (fused_) {
        count_events(grid_, events_);
        fused_->push(grid_.window, events_);
    }
    render_what_is_ready();
}

void ModelRun::finish() {
    renderer_.finish();
    render_what_is_ready();
    not_rendered_ += int(queries_.size());  // what is not ready even now
    queries_.clear();
}

void ModelRun::render_what_is_ready() {
    for (; !queries_.empty(); queries_.pop_front()) {
        const Query& query = queries_.front();
        const Readiness readiness = renderer_.readiness(query.t, options_.lookahead);
        if (readiness == Readiness::later) return;
        if (readiness == Readiness::gone) {
            ++not_rendered_;
            continue;
        }
        const RenderRequest request{.t = query.t,
                                    .width = query.width,
                                    .height = query.height,
                                    .region = query.region,
                                    .lookahead = options_.lookahead,
                                    .sigma_rule = options_.sigma_rule};
        if (frame_.intensity.empty()) frame_ = renderer_.make_output(request);
        if (fused_) {
            fused_->prepare(request);
            fused_->render(request, frame_);
        } else {
            renderer_.render(request, frame_);
        }
        use_(query, frame_);
    }
}

}  // namespace eventide
