// What a network whose products are bf16 does to single numbers: the input's compression, and the
// gates of a state that is kept in float32 and read in bf16. As right as bf16 asks for, and in one
// pass over memory.
#pragma once

#include <cstddef>
#include <cstdint>

namespace eventide {

/// kept = bf16(sigmoid(r) h), pixels of C channels: what the candidate reads of a state.
struct KeepRow {
    const float* r = nullptr;  ///< sums of the reset gate, `r_step` from one pixel to the next
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
    std::uint16_t* rounded = nullptr;        ///< h as bf16, with a zero beside the last of an odd C
    int channels = 0, pixels = 0;
    std::ptrdiff_t ahead = 0;  ///< numbers from h to those wanted soon, which are fetched
};

/// Pixels of the network's input, sign(v) log1p(|v|) of each number to within 1e-5, as bf16: in one
/// map or in several of 8 channels, with zeros for channels that are not there.
///
///     in       c0 .. c20 | c0 .. c20 | ...                 21 channels
///     one map of 32        c0 .. c20 0 .. 0 | ...          a pixel is a cache line
///     three of 8           c0 .. c7 | ..., then c8 .. c15 | ..., then c16 .. c20 0 0 0 | ...
struct CompressRow {
    const float* in = nullptr;     ///< [pixels][channels]
    int pixels = 0, channels = 0;  ///< channels <= size maps, and <= 1024
    std::ptrdiff_t ahead = 0;      ///< numbers from here to those wanted soon, which are fetched
    void* out = nullptr;           ///< [pixels][size] in the first map
    int size = 0, maps = 1;        ///< size even; 8 where there are several maps, 4 at most
    std::ptrdiff_t plane = 0;      ///< units of 4 bytes from one map to the next
};

namespace avx512_bf16 {

void keep_row(const KeepRow& row);
void update_row(const UpdateRow& row);
void compress_row(const CompressRow& row);

}  // namespace avx512_bf16
}  // namespace eventide
