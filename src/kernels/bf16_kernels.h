// Sums of products of bf16 numbers with float32 sums. The processor's instructions (AVX512_BF16,
// AMX) take two numbers at once, so channels go in pairs.
#pragma once

#include "src/kernels/bf16_gates.h"
#include "src/kernels/dot_area.h"
#include "src/kernels/vector_kernels.h"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace eventide {

/// A pair is a unit of 4 bytes: the even channel's number in its low half, the next channel's in
/// its high half. A pixel of 5 channels, and the product of two pairs:
///
///     unit        0            1            2
///     channels    c0 | c1      c2 | c3      c4 | 0
///     sum <- sum + low(in) low(weight) + high(in) high(weight)
struct Bf16Kernels {
    const char* name;       ///< of the instruction set
    bool by_quads = false;  ///< as VectorKernels::by_quads
    /// Whether dot_area reads rows of up to 64 bytes at once, several times as fast where they lie
    /// in one cache line each.
    bool by_lines = false;
    /// Units are pairs of bf16 numbers. Weights: blocks of two vectors of bf16_lanes(outputs), then
    /// one; [s][pair][output][2].
    void (*dot_area)(const DotArea&);
    /// `pixels` times `channels` numbers, one after the other, rounded to nearest even; an odd
    /// number of channels gets a zero beside the last.
    void (*pixels_to_bf16)(const float* in, std::size_t pixels, int channels, std::uint32_t* out);
    /// `n` numbers one after the other.
    void (*row_to_bf16)(const float* in, std::size_t n, std::uint16_t* out);
    void (*compress_row)(const CompressRow&);
    void (*keep_row)(const KeepRow&);
    void (*update_row)(const UpdateRow&);
    /// As VectorKernels::double_row, of bf16 numbers; `channels` counts them, and is even.
    void (*double_row)(const DoubleRow&);
    /// As VectorKernels::offset_rows, of bf16 numbers.
    void (*offset_rows)(const OffsetRows&);
    /// The sums of winograd.h, of an even number of channels or outputs; positions and outputs are
    /// bf16, products float32. Null where half of the products saves less than they cost.
    void (*winograd_input)(const WinogradInput&) = nullptr;
    void (*winograd_output)(const WinogradOutput&) = nullptr;
    /// Null where it would gain nothing; false, and nothing done, for layers it is not made for.
    bool (*hidden_rows)(const HiddenRows&);
};

constexpr int kBf16Lanes = 16;  ///< outputs per vector, at most
/// How many outputs a vector holds for a layer of so many: half a register does for 8.
constexpr int bf16_lanes(int outputs) {
    return outputs <= kBf16Lanes / 2 ? kBf16Lanes / 2 : kBf16Lanes;
}

/// Kernels by AMX where the processor has it, else by AVX512_BF16; null where it has neither, or
/// neither may be used.
const Bf16Kernels* bf16_kernels(Instructions most = Instructions::best);
/// Kernels by AMX; null where it is not there, the system does not allow it, or it may not be used.
const Bf16Kernels* amx_kernels(Instructions most = Instructions::best);

/// One number, rounded to nearest even; finite in, finite out except where it overflows.
inline std::uint16_t to_bf16(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    return std::uint16_t((bits + 0x7fffu + ((bits >> 16) & 1u)) >> 16);
}
inline float from_bf16(std::uint16_t value) {
    return std::bit_cast<float>(std::uint32_t{value} << 16);
}

namespace avx512_bf16 {

/// Whether the processor has the instructions; the kernels may be called only then.
bool there();
const Bf16Kernels& bf16_kernels();

}  // namespace avx512_bf16

namespace plain {

/// The judge of the fast ones: the same numbers on any processor, slowly.
const Bf16Kernels& bf16_kernels();

}  // namespace plain
}  // namespace eventide
