// What a network whose products are bf16 does to single numbers: the input's compression, and the
// gates of a state that is kept in float32 and read in bf16. As right as bf16 asks for, and in one
// pass over memory.
#pragma once

#include <cstddef>
#include <cstdint>

namespace eventide {

/// kept = bf16(sigmoid(r) h), pixels of C channels: what the candidate reads of a state.
struct KeepRow {
    const float* r = nullptr;   ///< sums of the reset gate, `r_step` from one pixel to the next
    std::ptrdiff_t r_step = 0;
    const std::uint16_t* h = nullptr;  ///< [pixels][C], with a zero beside the last of an odd C
    std::uint16_t* kept = nullptr;     ///< the same
    int channels = 0, pixels = 0;
};

/// h <- h + sigmoid(u) (c - h), c = tanh(v), pixels of C channels.
struct UpdateRow {
    const float *u = nullptr, *v = nullptr;  ///< sums of the layers, before their functions
    std::ptrdiff_t u_step = 0, v_step = 0;   ///< from one pixel to the next
    bool is_doubled = false;                 ///< what lies at v is 2 v
    float* h = nullptr;                      ///< [pixels][C], in and out
    std::uint16_t* rounded = nullptr;  ///< h as bf16, with a zero beside the last of an odd C
    int channels = 0, pixels = 0;
};

namespace avx512_bf16 {

void keep_row(const KeepRow& row);
void update_row(const UpdateRow& row);
/// As VectorKernels::compress, to within 1e-5 of the result.
void compress(const float* in, float* out, std::size_t n, std::ptrdiff_t ahead);

}  // namespace avx512_bf16
}  // namespace eventide
