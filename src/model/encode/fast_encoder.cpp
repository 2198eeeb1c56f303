// See fast_encoder.h.
#include "src/model/encode/fast_encoder.h"

#include <algorithm>
#include <atomic>

namespace eventide {
namespace {

std::uint64_t new_source() {
    static std::atomic<std::uint64_t> sources{0};
    return ++sources;
}

}  // namespace

FastEncoder::FastEncoder(const EngineOptions& options, const Arithmetic& arithmetic)
    : options_(options),
      arithmetic_(arithmetic),
      runner_(options.parallel_for, options.skip_quiet) {
    history_.source = new_source();
}

void FastEncoder::make_room(int height, int width, std::size_t scratch, std::size_t tiles) {
    latent_tiles_ = latent_tiles(height, width);
    history_.changed.resize(latent_tiles_.size());
    runner_.make_room(scratch, std::max(tiles, latent_tiles_.size()));
}

std::string FastEncoder::description() const {
    return std::string{"fast, "} + name_of(arithmetic_);
}

bool FastEncoder::is_outdated(std::size_t i, const LatentMap& latent) const noexcept {
    return StaleTiles{latent.history, history_}(i);
}

Tensors FastEncoder::state() const {
    Tensors state;
    for (std::size_t l = 0; l < states_.size(); ++l) {
        const StateMap& h = states_[l];
        Tensor& tensor = state["h." + std::to_string(l)];
        tensor.shape = {h.height(), h.width(), h.channels()};
        tensor.values.resize(element_count(tensor.shape));
        h.save(tensor.values.data());
    }
    return state;
}

void FastEncoder::restore(const Tensors& state) {
    for (std::size_t l = 0; l < states_.size(); ++l)
        states_[l].load(state.at("h." + std::to_string(l)).values.data());
    stale_ = true;
}

}  // namespace eventide
