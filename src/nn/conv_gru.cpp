// The fast ConvGRU: all between a tile's input and its new state stays in cache.
//
//     scratch      pixels         numbers                   read by
//     input a      (side + 4)^2   C as layers read them     gates, candidate
//     kept r.h     (side + 2)^2   C as layers read them     candidate
//     gates        (side + 2)^2   2 C float32: u, r         kept, new state
//     candidate    side^2         C float32                 new state
//
// At side 48 with C = 8 in float32: 21632 + 20000 + 40000 + 18432 numbers, 391 KiB.
//
// h is read by the gates where it lies, in the state's map. Each 3x3 layer reads one pixel more on
// each side than it puts out, so that a tile's step has rims, which neighbouring tiles compute,
// too:
//
//     a a a a a a a a     candidate and new state: the tile (t)
//     a g g g g g g a     gates and r.h: it and 1 more (g), of which the candidate reads
//     a g t t t t g a     input: it and 2 more (a), of which the gates read
//     a g t t t t g a
//     a g g g g g g a     Past the map's edge there is nothing to compute: zeros, which begin()
//     a a a a a a a a     writes for the tiles that lie there.
//
// Without a reset gate u and the candidate read the same: one layer of 2 C outputs over the tile,
// whose input is the tile and 1 more. With the candidate's weights doubled one function opens both
// halves, as tanh(v) = 2 sigmoid(2 v) - 1.
#include "src/nn/conv_gru.h"

#include "src/kernels/vector_kernels.h"

#include <algorithm>
#include <cstring>

namespace eventide {
namespace {

std::size_t square(int n) {
    return std::size_t(n) * std::size_t(n);
}

/// [gates; 2 candidate] as one layer.
plain::ConvWeights<float> with_doubled(const plain::ConvWeights<float>& gates,
                                       const plain::ConvWeights<float>& candidate) {
    plain::ConvWeights<float> both = gates;
    both.out += candidate.out;
    for (const float w : candidate.weight) both.weight.push_back(2 * w);
    for (const float b : candidate.bias) both.bias.push_back(2 * b);
    return both;
}

}  // namespace

ConvGru::ConvGru(const plain::GruWeights<float>& weights, Extent map,
                 const std::vector<Tile>& tiles, int side, const Backend& backend, std::size_t held)
    : channels_(weights.candidate.out),
      side_(side),
      reach_(weights.gates.out == 2 * channels_ ? 2 : 1),
      tiles_(tiles),
      gates_(has_reset() ? weights.gates : with_doubled(weights.gates, weights.candidate), 1, false,
             backend, extents_of(tiles, reach_ - 1, map.height, map.width),
             {channels_, channels_}) {
    if (has_reset())
        candidate_ = {
            weights.candidate,     1, false, backend, extents_of(tiles, 0, map.height, map.width),
            {channels_, channels_}};
    std::size_t largest = 0;
    for (const Tile& tile : tiles_)
        largest = std::max(largest, std::size_t(tile.height()) * std::size_t(tile.width()));
    next_.assign(held == 0 ? tiles_.size() : std::min(held, tiles_.size()),
                 FloatBuffer(largest * std::size_t(units())));
}

/// Whole cache lines, so that what lies behind begins with one.
std::size_t ConvGru::scratch_size() const {
    const auto c = std::size_t(channels_), u = std::size_t(units());
    std::size_t size = square(input_side()) * u + square(gates_side()) * 2 * c;
    if (has_reset())
        size += square(side_ + 2) * u + square(side_) * c +
                std::max(gates_.scratch_size(side_ + 2, side_ + 2),
                         candidate_.scratch_size(side_, side_));
    else
        size += gates_.scratch_size(side_, side_);
    constexpr std::size_t kLine = 64 / sizeof(float);
    return (size + kLine - 1) / kLine * kLine;
}

/// What lies outside the map reads as zero.
void ConvGru::begin(std::size_t i, float* scratch, const Tile& near) const noexcept {
    const Tile& tile = tiles_[i];
    clear_outside(tile.widened(reach_), near, scratch, input_pitch(), units());
    if (!has_reset()) return;
    clear_outside(tile.widened(1), tile.widened(1).within(near),
                  scratch + (side_ + 4) * input_pitch(), kept_pitch(), units());
}

void ConvGru::finish(StateMap& state, std::size_t i, const Mask* mask, float* input) noexcept {
    const Tile& tile = tiles_[i];
    float* kept = input + input_side() * input_pitch();
    float* gates = has_reset() ? kept + (side_ + 2) * kept_pitch() : kept;
    float* candidate = gates + gates_side() * gates_pitch();
    float* scratch =
        has_reset() ? candidate + std::ptrdiff_t(side_) * side_ * channels_ : candidate;

    const Tile close = tile.grown(reach_ - 1, state.height(), state.width());
    const PaddedMap& h = state.read();
    gates_.run(ConvArea{.in = {{{input_at(input, i, close.y0 - 1, close.x0 - 1), input_pitch()},
                                {h.at(close.y0 - 1, close.x0 - 1), h.pitch()}}},
                        .out = gates_at(gates, i, close.y0, close.x0),
                        .out_pitch = gates_pitch(),
                        .height = close.height(),
                        .width = close.width()},
               scratch);
    const bool is_rounded = state.has_both();
    if (!has_reset())
        return is_rounded ? update_rounded(state, i, mask, gates, nullptr)
                          : update_light(state, i, mask, gates);
    keep(state, i, close, gates, kept);
    candidate_.run(ConvArea{.in = {{{input_at(input, i, tile.y0 - 1, tile.x0 - 1), input_pitch()},
                                    {kept_at(kept, i, tile.y0 - 1, tile.x0 - 1), kept_pitch()}}},
                            .out = candidate,
                            .out_pitch = std::ptrdiff_t(tile.width()) * channels_,
                            .height = tile.height(),
                            .width = tile.width()},
                   scratch);
    is_rounded ? update_rounded(state, i, mask, gates, candidate)
               : update(state, i, mask, gates, candidate);
}

/// What the gates keep of the state: kept = r.h. In float32 they are opened on the way, and stay so
/// for update(): [u; r] = sigmoid(gates).
void ConvGru::keep(const StateMap& state, std::size_t i, const Tile& close, float* gates,
                   float* kept) const noexcept {
    const Numbers& numbers = state.numbers();
    const std::ptrdiff_t step = 2 * std::ptrdiff_t(channels_);
    for (int y = close.y0; y < close.y1; ++y) {
        float* sums = gates_at(gates, i, y, close.x0);
        const float* h = state.read().at(y, close.x0);
        float* to = kept_at(kept, i, y, close.x0);
        if (numbers.bf16() != nullptr) {
            numbers.bf16()->keep_row({.r = sums + channels_,
                                      .r_step = step,
                                      .h = reinterpret_cast<const std::uint16_t*>(h),
                                      .kept = reinterpret_cast<std::uint16_t*>(to),
                                      .channels = channels_,
                                      .pixels = close.width()});
            continue;
        }
        numbers.kernels().sigmoid(sums, std::size_t(close.width()) * std::size_t(step));
        numbers.kernels().reset_state(sums + channels_, step, h, to, channels_, close.width());
    }
}

/// next = h + u (tanh(candidate) - h), where the mask lets it. Until commit() neighbours read the
/// old h.
void ConvGru::update(const StateMap& state, std::size_t i, const Mask* mask, float* gates,
                     float* candidate) noexcept {
    const Tile& tile = tiles_[i];
    const std::ptrdiff_t row = std::ptrdiff_t(tile.width()) * channels_;
    float* next = next_[i % next_.size()].data();
    for (int y = tile.y0; y < tile.y1; ++y, next += row, candidate += row) {
        state.numbers().kernels().update_state(
            state.exact().at(y, tile.x0), gates_at(gates, i, y, tile.x0),
            2 * std::ptrdiff_t(channels_), candidate, next, channels_, tile.width());
        if (mask != nullptr) keep_unmasked(state.exact(), *mask, y, tile, next);
    }
}

/// The same of both halves of one layer: u, and s with 2 s - 1 = tanh(candidate).
void ConvGru::update_light(const StateMap& state, std::size_t i, const Mask* mask,
                           float* halves) noexcept {
    const Tile& tile = tiles_[i];
    const VectorKernels& kernels = state.numbers().kernels();
    const std::ptrdiff_t row = std::ptrdiff_t(tile.width()) * channels_;
    float* next = next_[i % next_.size()].data();
    for (int y = tile.y0; y < tile.y1; ++y, next += row, halves += gates_pitch()) {
        kernels.sigmoid(halves, 2 * std::size_t(row));
        kernels.update_light(state.exact().at(y, tile.x0), halves, next, channels_, tile.width());
        if (mask != nullptr) keep_unmasked(state.exact(), *mask, y, tile, next);
    }
}

/// Both of the above where the state is bf16 to layers: the exact one at once, as no other tile
/// reads it; what layers read in commit(). Without `candidate` both halves are in `gates`.
///
///     mask of a row    1 1 1 0 0 1        updated: pixels 0 to 2, then 5; copied: 3 and 4
void ConvGru::update_rounded(StateMap& state, std::size_t i, const Mask* mask, float* gates,
                             const float* candidate) noexcept {
    const Tile& tile = tiles_[i];
    const std::ptrdiff_t unit = units(), both = 2 * std::ptrdiff_t(channels_);
    float* next = next_[i % next_.size()].data();
    for (int y = tile.y0; y < tile.y1; ++y, next += tile.width() * unit) {
        const std::ptrdiff_t ahead = to_row_ahead(tile, y, state.exact().pitch());
        const auto is_masked = [&](int x) { return mask == nullptr || (*mask)(y, x) != 0; };
        for (int x = tile.x0, end = x; x < tile.x1; x = end) {
            while (end < tile.x1 && is_masked(end) == is_masked(x)) ++end;
            float* to = next + (x - tile.x0) * unit;
            if (!is_masked(x)) {
                std::memcpy(to, state.read().at(y, x),
                            std::size_t((end - x) * unit) * sizeof(float));
                continue;
            }
            const float* u = gates_at(gates, i, y, x);
            const float* v =
                candidate == nullptr
                    ? u + channels_
                    : candidate + ((y - tile.y0) * tile.width() + x - tile.x0) * channels_;
            state.numbers().bf16()->update_row({.u = u,
                                                .v = v,
                                                .u_step = both,
                                                .v_step = candidate == nullptr ? both : channels_,
                                                .is_doubled = candidate == nullptr,
                                                .h = state.exact().at(y, x),
                                                .rounded = reinterpret_cast<std::uint16_t*>(to),
                                                .channels = channels_,
                                                .pixels = end - x,
                                                .ahead = ahead});
        }
    }
}

/// States outside the mask stay as they are, bit for bit.
void ConvGru::keep_unmasked(const PaddedMap& state, const Mask& mask, int y, const Tile& tile,
                            float* next) const noexcept {
    const auto c = std::size_t(channels_);
    const std::uint8_t* row = &mask(y, tile.x0);
    if (std::memchr(row, 0, std::size_t(tile.width())) == nullptr) return;
    for (int x = tile.x0; x < tile.x1; ++x, next += c)
        if (mask(y, x) == 0) std::memcpy(next, state.at(y, x), c * sizeof(float));
}

void ConvGru::commit(StateMap& state, std::size_t i) noexcept {
    const Tile& tile = tiles_[i];
    const std::ptrdiff_t row = std::ptrdiff_t(tile.width()) * units();
    const float* next = next_[i % next_.size()].data();
    for (int y = tile.y0; y < tile.y1; ++y, next += row)
        std::memcpy(state.read().at(y, tile.x0), next, std::size_t(row) * sizeof(float));
}

}  // namespace eventide
