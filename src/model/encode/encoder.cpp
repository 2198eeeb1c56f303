// Encoder: checks at construction, then hands over to the engine that was chosen.
#include "src/model/encode/encoder.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"
#include "src/model/cores.h"
#include "src/model/mirrors.h"
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
    : width_(width), height_(height), bins_(model.config.bins) {
    check_size(width, height);
    check_model(model, "encoder");
    check_self_ensemble(options.self_ensemble);
    latent_height_ = latent_samples(height, model.config.latent_stride);
    latent_width_ = latent_samples(width, model.config.latent_stride);
    latent_channels_ = model.config.latent;
    identity_ = encoder_identity(model);
    for (int view = 0; view < options.self_ensemble; ++view)
        cores_.push_back(options.engine == Engine::plain
                             ? make_plain_encoder(model, height, width)
                             : make_fast_encoder(model, height, width, options));
    if (cores_.size() == 1) return;
    mirrored_.values = {height, width, 4 * bins_ + 1};
    mirrored_.touched = {height, width};
}

Encoder::~Encoder() = default;
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;

std::string Encoder::description() const {
    const std::string one = cores_.front()->description();
    return cores_.size() == 1 ? one : one + ", " + std::to_string(cores_.size()) + " views";
}

LatentMap Encoder::make_output() const {
    LatentMap latent;
    const auto make = [this](LatentCodes& codes) {
        codes.is_bf16 = cores_.front()->gives_bf16();
        codes.values = {latent_height_, latent_width_,
                        codes.is_bf16 ? (latent_channels_ + 1) / 2 : latent_channels_};
        codes.history.changed.reserve(latent_tiles(latent_height_, latent_width_).size());
    };
    make(latent);
    latent.mirrored.resize(cores_.size() - 1);
    for (LatentCodes& codes : latent.mirrored) make(codes);
    return latent;
}

void Encoder::step(const VoxelGrid& grid, LatentMap& latent) noexcept {
    cores_.front()->step(grid, latent);
    for (std::size_t view = 1; view < cores_.size(); ++view) {
        mirror(grid, kMirrors[view], mirrored_);
        cores_[view]->step(mirrored_, latent.mirrored[view - 1]);
    }
}

void Encoder::reset() noexcept {
    for (const auto& core : cores_) core->reset();
}

namespace {

/// The hidden maps of the first view are called as they are, those of the second "view1.h.0".
std::string of_view(std::size_t view, const std::string& name) {
    return view == 0 ? name : "view" + std::to_string(view) + "." + name;
}

}  // namespace

TensorFile Encoder::state() const {
    TensorFile file{{{"format", "eventide-state"},
                     {"version", "1"},
                     {"model", identity_},
                     {"width", std::to_string(width_)},
                     {"height", std::to_string(height_)}},
                    {}};
    for (std::size_t view = 0; view < cores_.size(); ++view)
        for (auto& [name, tensor] : cores_[view]->state())
            file.tensors[of_view(view, name)] = std::move(tensor);
    return file;
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
    const std::size_t each = mine.tensors.size() / cores_.size(),
                      kept = state.tensors.size() / each;
    if (kept != cores_.size() && state.tensors.size() == kept * each)
        refuse_state(name, "state of a self-ensemble", counted(cores_.size(), "network"),
                     std::to_string(kept));
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
    for (std::size_t view = 0; view < cores_.size(); ++view) {
        Tensors seen;
        for (const auto& [map, tensor] : cores_[view]->state())
            seen[map] = state.tensors.at(of_view(view, map));
        cores_[view]->restore(seen);
    }
}

}  // namespace eventide
