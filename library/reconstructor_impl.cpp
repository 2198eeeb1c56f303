// The network at work: how its streams begin.
#include "library/reconstructor_impl.h"

#include "library/network_options.h"

#include <string>

namespace eventide {

Reconstructor::Impl::Impl(const Model& model, int width, int height,
                          const ReconstructorOptions& options)
    : options_(options),
      engine_(engine_of(options)),
      intake_(slicer_of(options, model.config), width, height,
              filter_of(options, model.config, width, height), counters_),
      binner_(model.config.bins, height, width),
      encoder_(model, width, height, engine_),
      renderer_(model, width, height, engine_),
      grid_(binner_.make_output()),
      latent_(encoder_.make_output()),
      schedule_(rate_of(options)) {
    request_.lookahead = options.lookahead;
    request_.want_sigma = options.sigma;
    if (options.images) {
        fused_.emplace(renderer_, width, height, options.lookahead);
        fused_->keep_at_most(FusedRenderer::kMaxWaitingOfRecording);
        latent_.events_per_pixel = Array2<float>(height, width);
        intake_.hold_images();
    }
    Frame frame;
    make_room(options.size, frame);
}

void Reconstructor::Impl::forget_stream() {
    renderer_.reset();
    if (fused_) fused_->reset();
    seen_.fill({});
    encoded_ = opened_ = 0;
    silence_ = {};
    has_images_ = new_clock_ = ended_ = false;
}

void Reconstructor::Impl::forget_events() {
    intake_.reset();
    binner_.reset();
    forget_stream();
    gaps_ = {};
    follows_ = false;
    schedule_ = FrameSchedule{rate_of(options_)};
}

void Reconstructor::Impl::reset() {
    forget_events();
    encoder_.reset();
}

void Reconstructor::Impl::restore(const TensorFile& state, const std::string& name) {
    encoder_.restore(state, name);
    forget_events();
}

}  // namespace eventide
