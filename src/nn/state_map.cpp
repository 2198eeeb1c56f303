// See state_map.h.
#include "src/nn/state_map.h"

#include <string>

namespace eventide {

Tensors tensors_of(const std::vector<StateMap>& states) {
    Tensors tensors;
    for (std::size_t l = 0; l < states.size(); ++l) {
        const StateMap& h = states[l];
        Tensor& tensor = tensors["h." + std::to_string(l)];
        tensor.shape = {h.height(), h.width(), h.channels()};
        tensor.values.resize(element_count(tensor.shape));
        h.save(tensor.values.data());
    }
    return tensors;
}

void load(const Tensors& state, std::vector<StateMap>& states) {
    for (std::size_t l = 0; l < states.size(); ++l)
        states[l].load(state.at("h." + std::to_string(l)).values.data());
}

}  // namespace eventide
