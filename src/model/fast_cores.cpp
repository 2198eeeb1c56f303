// Which fast network stands behind Encoder and Renderer, and what it computes by.
#include "src/core/error.h"
#include "src/model/cores.h"
#include "src/model/encode/gated_encoder.h"
#include "src/model/encode/thesis_encoder.h"
#include "src/model/render/fast_renderer.h"

namespace eventide {
namespace {

Backend backend_for(const EngineOptions& options) {
    const Bf16Kernels* bf16 = bf16_kernels(options.instructions);
    if (options.precision == Precision::bf16 && !options.emulate_bf16 && bf16 == nullptr)
        throw Error(ErrorKind::usage,
                    "precision bf16: expected a processor with AVX512_BF16, found none; use f32");
    if (options.kernels == Kernels::onednn && !onednn_available())
        throw Error(ErrorKind::usage,
                    "kernels onednn: expected a program built with oneDNN (EVENTIDE_ONEDNN), found "
                    "one without; use own");
    if (options.emulate_bf16)
        return {&vector_kernels(options.instructions), &plain::bf16_kernels()};
    // What pays best of what is allowed; what was asked for by name then takes its place.
    Backend chosen = fastest_backend(options.instructions, options.precision != Precision::f32,
                                     options.kernels != Kernels::own);
    if (options.precision == Precision::bf16) chosen.bf16 = bf16;
    if (options.kernels != Kernels::automatic) chosen.onednn = options.kernels == Kernels::onednn;
    if (chosen.onednn && chosen.bf16 != nullptr && !onednn_has_bf16())
        throw Error(ErrorKind::usage,
                    "kernels onednn: expected to be allowed AVX512_BF16 for bf16, found "
                    "ONEDNN_MAX_CPU_ISA below it; use f32 or own");
    return chosen;
}

}  // namespace

std::unique_ptr<EncoderCore> make_fast_encoder(const Model& model, int height, int width,
                                               const EngineOptions& options) {
    const Backend backend = backend_for(options);
    if (model.config.encoder == EncoderKind::gated)
        return std::make_unique<GatedEncoder>(model, height, width, options, backend);
    return std::make_unique<ThesisEncoder>(model, height, width, options, backend);
}
std::unique_ptr<RendererCore> make_fast_renderer(const Model& model, int sensor_width,
                                                 int sensor_height, const EngineOptions& options) {
    return std::make_unique<FastRenderer>(model, sensor_width, sensor_height, options,
                                          backend_for(options));
}

}  // namespace eventide
