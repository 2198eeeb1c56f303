// Sums of products of bf16 numbers with float32 sums. The processor's instruction (AVX512_BF16)
// takes two numbers at once, so channels go in pairs.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace eventide {

/// As DotRows (vector_kernels.h), but `in` holds pairs of bf16 numbers and `length`, `pitch` and
/// `step` count pairs. Weights: blocks of two vectors of bf16_lanes(outputs), then one;
/// [s][pair][output][2].
struct Bf16DotRows {
    const std::uint32_t* in = nullptr;
    std::ptrdiff_t pitch = 0, step = 0;
    int stretches = 0, length = 0;
    int pixels = 0;
    int outputs = 0;
    const std::uint32_t* weight = nullptr;
    const float* bias = nullptr;  ///< [outputs rounded up to 16]
    bool relu = false;
    float* out = nullptr;
    std::ptrdiff_t out_step = 0;
};

struct Bf16Kernels {
    void (*dot_rows)(const Bf16DotRows&);
    /// `pixels` times `channels` numbers, one after the other, rounded to nearest even; an odd
    /// number of channels gets a zero beside the last.
    void (*pixels_to_bf16)(const float* in, std::size_t pixels, int channels, std::uint32_t* out);
    /// `n` numbers one after the other.
    void (*row_to_bf16)(const float* in, std::size_t n, std::uint16_t* out);
};

constexpr int kBf16Lanes = 16;  ///< outputs per vector, at most
/// How many outputs a vector holds for a layer of so many: half a register does for 8.
constexpr int bf16_lanes(int outputs) {
    return outputs <= kBf16Lanes / 2 ? kBf16Lanes / 2 : kBf16Lanes;
}

/// Null where the processor has no such instruction, or limit_kernels_to_avx2() was called.
const Bf16Kernels* bf16_kernels();

/// One number, rounded to nearest even; finite in, finite out except where it overflows.
inline std::uint16_t to_bf16(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return std::uint16_t((bits + 0x7fffu + ((bits >> 16) & 1u)) >> 16);
}

namespace plain {

/// The judge of the fast ones: the same numbers on any processor, slowly.
const Bf16Kernels& bf16_kernels();

}  // namespace plain
}  // namespace eventide
