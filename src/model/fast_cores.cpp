// stand-in until the kernels are there
#include "src/model/cores.h"

namespace eventide {

std::unique_ptr<EncoderCore> make_fast_encoder(const Model& model, int height, int width,
                                               const EngineOptions&) {
    return make_plain_encoder(model, height, width);
}
std::unique_ptr<RendererCore> make_fast_renderer(const Model& model, int, int,
                                                 const EngineOptions&) {
    return make_plain_renderer(model);
}

}  // namespace eventide
