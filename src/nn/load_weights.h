// Tensors of a model file as the plain layers take them.
#pragma once

#include "src/kernels/plain/activations.h"
#include "src/kernels/plain/conv.h"
#include "src/nn/safetensors.h"

#include <string>
#include <vector>

namespace eventide::plain {

/// Names are those of docs/model.md with their prefix; the tensors must be there (check_model).
template <typename T>
std::vector<T> vector_of(const Tensors& tensors, const std::string& name) {
    const std::vector<float>& values = tensors.at(name).values;
    return {values.begin(), values.end()};
}
template <typename T>
ConvWeights<T> conv_weights(const Tensors& tensors, const std::string& name) {
    const auto& shape = tensors.at(name + ".weight").shape;
    return {int(shape[0]), int(shape[1]), vector_of<T>(tensors, name + ".weight"),
            vector_of<T>(tensors, name + ".bias"), int(shape[2])};
}
template <typename T>
GruWeights<T> gru_weights(const Tensors& tensors, const std::string& name) {
    return {conv_weights<T>(tensors, name + ".gates"),
            conv_weights<T>(tensors, name + ".candidate")};
}
template <typename T>
NormWeights<T> norm_weights(const Tensors& tensors, const std::string& name) {
    return {vector_of<T>(tensors, name + ".alpha"), vector_of<T>(tensors, name + ".gamma"),
            vector_of<T>(tensors, name + ".beta")};
}

}  // namespace eventide::plain
