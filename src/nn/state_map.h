// What a level remembers, as layers read it and, where it is summed up over time, in float32.
#pragma once

#include "src/nn/numbers.h"
#include "src/nn/padded_map.h"
#include "src/nn/safetensors.h"

#include <vector>

namespace eventide {

/// In float32 both are one map. In bf16 a state that a GRU updates is kept in float32 beside the
/// bf16 numbers that layers read; of any other only these are kept.
///
///                               read()           exact()
///     float32                   h                the same map
///     bf16, is_updated          h, rounded       h
///     bf16, held features       h, rounded       not to be asked for
class StateMap {
public:
    StateMap() = default;
    StateMap(int height, int width, int channels, const Numbers& numbers, bool is_updated)
        : channels_(channels), numbers_(numbers), read_(height, width, numbers.units(channels)) {
        if (numbers.bf16() != nullptr && is_updated) exact_ = {height, width, channels};
    }

    int height() const { return read_.height(); }
    int width() const { return read_.width(); }
    int channels() const { return channels_; }
    const Numbers& numbers() const { return numbers_; }
    /// What layers read.
    PaddedMap& read() { return read_; }
    const PaddedMap& read() const { return read_; }
    /// Float32; of a state that is updated.
    PaddedMap& exact() { return exact_.height() > 0 ? exact_ : read_; }
    const PaddedMap& exact() const { return exact_.height() > 0 ? exact_ : read_; }
    bool has_both() const { return exact_.height() > 0; }

    void clear() {
        read_.clear();
        exact_.clear();
    }
    /// `from` and `to` are [height][width][channels] without a border.
    void load(const float* from) {
        if (has_both()) exact_.load(from);
        for (int y = 0; y < height(); ++y)
            numbers_.from_float(from + y * row(), std::size_t(width()), channels_, read_.at(y, 0));
    }
    void save(float* to) const {
        if (has_both()) {
            exact_.save(to);
            return;
        }
        for (int y = 0; y < height(); ++y)
            numbers_.to_float(read_.at(y, 0), std::size_t(width()), channels_, to + y * row());
    }

private:
    std::ptrdiff_t row() const { return std::ptrdiff_t(width()) * channels_; }
    int channels_ = 0;
    Numbers numbers_;
    PaddedMap read_, exact_;
};

/// "h.0", "h.1", ...: [height, width, channels] each.
Tensors tensors_of(const std::vector<StateMap>& states);
/// `state` has their names and shapes.
void load(const Tensors& state, std::vector<StateMap>& states);

}  // namespace eventide
