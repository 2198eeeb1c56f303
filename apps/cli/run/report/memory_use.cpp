// Sums of the largest arrays.
#include "apps/cli/run/report/memory_use.h"

#include "src/model/latent_window.h"
#include "src/model/render/sampling.h"

namespace eventide::app {

namespace {

constexpr std::uint64_t kFloat = sizeof(float);

std::uint64_t latent_pixels(const ModelConfig& config, const SensorInfo& sensor) {
    return std::uint64_t(latent_samples(sensor.width, config.latent_stride)) *
           std::uint64_t(latent_samples(sensor.height, config.latent_stride));
}

std::uint64_t least_code_bytes(Precision precision) {
    return precision == Precision::f32 ? kFloat : kFloat / 2;
}

}  // namespace

std::uint64_t network_bytes(const ModelConfig& config, const SensorInfo& sensor,
                            Precision precision) {
    // Per latent pixel: the kept latent maps, and the renderer's first layer for two of them.
    const int numbers = LatentWindow::kLatentsKept * config.latent + 2 * config.mlp[0];
    return latent_pixels(config, sensor) * std::uint64_t(numbers) * least_code_bytes(precision);
}

std::uint64_t buffer_bytes(const ModelConfig& config, const SensorInfo& sensor,
                           const PipelineBuffers& buffers, Precision precision) {
    const std::uint64_t pixels = std::uint64_t(sensor.width) * std::uint64_t(sensor.height);
    const std::uint64_t codes = latent_pixels(config, sensor) * std::uint64_t(config.latent);
    return buffers.grids * pixels * std::uint64_t(config.input_channels()) * kFloat +
           buffers.latents * codes * least_code_bytes(precision);
}

std::uint64_t frame_bytes(const RenderRequest& request, const SensorInfo& sensor) {
    const FrameGeometry part = geometry_of(request, sensor.width, sensor.height);
    const std::uint64_t numbers = request.want_sigma ? 2 : 1;
    return std::uint64_t(part.part_width) * std::uint64_t(part.part_height) * numbers * kFloat;
}

Error out_of_memory(const std::string& what, std::uint64_t bytes, const SensorInfo& sensor) {
    return {ErrorKind::failed, "out of memory: " + what + " for a sensor of " +
                                   std::to_string(sensor.width) + "x" +
                                   std::to_string(sensor.height) + " wants at least " +
                                   std::to_string((bytes >> 20) + 1) + " MiB"};
}

}  // namespace eventide::app
