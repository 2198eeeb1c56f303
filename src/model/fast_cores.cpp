// Which fast network stands behind Encoder and Renderer, and with which numbers.
#include "src/core/error.h"
#include "src/model/cores.h"
#include "src/model/fast_gated_encoder.h"
#include "src/model/fast_renderer.h"
#include "src/model/fast_thesis_encoder.h"

namespace eventide {
namespace {

bool wants_bf16(Precision precision) {
    if (precision == Precision::bf16 && !bf16_available())
        throw Error(ErrorKind::usage,
                    "precision bf16: expected a processor with AVX512_BF16, found none; use f32");
    return precision == Precision::bf16 || (precision == Precision::automatic && bf16_is_faster());
}

}  // namespace

std::unique_ptr<EncoderCore> make_fast_encoder(const Model& model, int height, int width,
                                               const EngineOptions& options) {
    const bool bf16 = wants_bf16(options.precision);
    if (model.config.encoder == EncoderKind::gated)
        return std::make_unique<FastGatedEncoder>(model, height, width, options, bf16);
    return std::make_unique<FastThesisEncoder>(model, height, width, options, bf16);
}
std::unique_ptr<RendererCore> make_fast_renderer(const Model& model, int sensor_width,
                                                 int sensor_height, const EngineOptions& options) {
    return std::make_unique<FastRenderer>(model, sensor_width, sensor_height, options,
                                          wants_bf16(options.precision));
}

}  // namespace eventide
