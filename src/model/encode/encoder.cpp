// Encoder: checks at construction, then hands over to the engine that was chosen.
#include "src/model/encode/encoder.h"

#include "src/core/error.h"
#include "src/core/sensor_limits.h"
#include "src/model/cores.h"
#include "src/model/render/sampling.h"
#include "src/nn/tiling.h"

#include <utility>

namespace eventide {
namespace {

void check_size(int width, int height) {
    if (width < 1 || width > kLargestSensorSide || height < 1 || height > kLargestSensorSide)
        throw Error(ErrorKind::usage, "sensor size: expected 1 to " +
                                          std::to_string(kLargestSensorSide) + " px, found " +
                                          std::to_string(width) + "x" + std::to_string(height));
}

}  // namespace

Encoder::Encoder(const Model& model, int width, int height, const EngineOptions& options)
    : width_(width),
      height_(height),
      bins_(model.config.bins),
      latent_height_(latent_samples(height, model.config.latent_stride)),
      latent_width_(latent_samples(width, model.config.latent_stride)),
      latent_channels_(model.config.latent) {
    check_size(width, height);
    check_model(model, "encoder");
    identity_ = encoder_identity(model);
    core_ = options.engine == Engine::plain ? make_plain_encoder(model, height, width)
                                            : make_fast_encoder(model, height, width, options);
}

Encoder::~Encoder() = default;
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;

std::string Encoder::description() const {
    return core_->description();
}

LatentMap Encoder::make_output() const {
    LatentMap latent;
    latent.is_bf16 = core_->gives_bf16();
    latent.values = {latent_height_, latent_width_,
                     latent.is_bf16 ? (latent_channels_ + 1) / 2 : latent_channels_};
    latent.history.changed.reserve(latent_tiles(latent_height_, latent_width_).size());
    return latent;
}

void Encoder::step(const VoxelGrid& grid, LatentMap& latent) noexcept {
    core_->step(grid, latent);
}

void Encoder::reset() noexcept {
    core_->reset();
}

TensorFile Encoder::state() const {
    return {{{"format", "eventide-state"},
             {"version", "1"},
             {"model", identity_},
             {"width", std::to_string(width_)},
             {"height", std::to_string(height_)}},
            core_->state()};
}

namespace {

[[noreturn]] void refuse_state(const std::string& name, const std::string& what,
                               const std::string& expected, const std::string& found) {
    throw Error(ErrorKind::input,
                name + ": " + what + ": expected " + expected + ", found " + found);
}

}  // namespace

void Encoder::restore(const TensorFile& state, const std::string& name) {
    const TensorFile mine = this->state();
    for (const auto& [key, expected] : mine.metadata) {
        const auto found = state.metadata.find(key);
        const std::string value = found == state.metadata.end() ? "nothing" : found->second;
        if (value != expected) refuse_state(name, "state's '" + key + "'", expected, value);
    }
    for (const auto& [key, expected] : mine.tensors) {
        const auto found = state.tensors.find(key);
        if (found == state.tensors.end() || found->second.shape != expected.shape)
            refuse_state(
                name, "tensor '" + key + "'", "shape " + shape_text(expected.shape),
                found == state.tensors.end() ? "no such tensor" : shape_text(found->second.shape));
    }
    if (state.tensors.size() != mine.tensors.size())
        throw Error(ErrorKind::input, name + ": expected " + std::to_string(mine.tensors.size()) +
                                          " tensors, found " +
                                          std::to_string(state.tensors.size()));
    core_->restore(state.tensors);
}

}  // namespace eventide
