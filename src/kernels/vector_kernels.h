// The fast kernels: one text over Highway's vectors, compiled for several instruction sets and
// chosen at run time. All take plain pointers; nothing is allocated.
#pragma once

#include <cstddef>
#include <string>

namespace eventide {

/// Many sums of products with the same weights, over overlapping stretches of memory:
///   out[p out_step + o] = act(bias[o] + sum over s, k of in[s pitch + p step + k] weight[s][k][o])
/// A 3x3 convolution's row of pixels is this with three stretches of 3 C numbers (C of them per
/// pixel, channels last); a linear layer is this with one. Every output is summed in the order of
/// s, k with fused multiply-adds, so the result depends on no blocking, and AVX2 and AVX-512 agree.
struct DotRows {
    const float* in = nullptr;
    std::ptrdiff_t pitch = 0;  ///< from one stretch to the next, in numbers
    std::ptrdiff_t step = 0;   ///< from one pixel to the next
    int stretches = 0, length = 0;
    int pixels = 0;
    int outputs = 0;
    int lanes = 0;                  ///< dot_lanes(outputs)
    const float* weight = nullptr;  ///< as pack_weights lays them out for so many lanes
    const float* bias = nullptr;    ///< [outputs rounded up to lanes]
    bool relu = false;
    float* out = nullptr;
    std::ptrdiff_t out_step = 0;
};

/// The first layer of the renderer's network, where its convolution is known:
/// out[p][n] = max(0, sums[p pitch + n] + base[n] + dx[p] slope[n])
struct OffsetRows {
    const float* sums = nullptr;
    const int* column = nullptr;  ///< [pixels] which pixel of `sums`
    const float* dx = nullptr;    ///< [pixels]
    const float* base = nullptr;
    const float* slope = nullptr;
    int pixels = 0, width = 0;  ///< width: n
    float* out = nullptr;       ///< [pixels][width]
};

struct VectorKernels {
    const char* name;  ///< of the instruction set
    int lanes;         ///< float32 numbers per vector
    void (*dot_rows)(const DotRows&);
    /// out = sign(v) log1p(|v|)
    void (*compress)(const float* in, float* out, std::size_t n);
    /// Pixels of C channels that lie one after the other, to places `to_step` numbers apart.
    void (*spread)(const float* from, float* to, std::ptrdiff_t to_step, int channels, int pixels);
    /// h <- sigmoid(r) h, for pixels of C channels, so many numbers from one to the next.
    void (*reset_state)(const float* r, std::ptrdiff_t r_step, float* h, std::ptrdiff_t h_step,
                        int channels, int pixels);
    /// out = h + sigmoid(u) (tanh(c) - h), for pixels of C channels, all but u one after the other.
    void (*update_state)(const float* h, const float* u, std::ptrdiff_t u_step, const float* c,
                         float* out, int channels, int pixels);
    /// out = relu(a + b)
    void (*add_relu)(const float* a, const float* b, float* out, std::size_t n);
    /// out = elu(a[c] scale[c] + shift[c] + skip), for n pixels of C channels; skip may be null
    void (*norm_elu)(const float* a, const float* scale, const float* shift, const float* skip,
                     float* out, std::size_t pixels, int channels);
    void (*elu)(const float* in, float* out, std::size_t n);
    /// out = (a + b + c + d) / 4
    void (*average)(const float* a, const float* b, const float* c, const float* d, float* out,
                    int n);
    /// Whether |a - b| <= bound for each of n numbers; not where one is NaN.
    bool (*are_near)(const float* a, const float* b, float bound, std::size_t n);
    void (*offset_rows)(const OffsetRows&);
    /// out[p][0..1] = bias + weight[0..1] . in[p], weight [2][width]
    void (*two_outputs)(const float* in, const float* weight, const float* bias, int pixels,
                        int width, float* out);
};

/// The best the processor has.
const VectorKernels& vector_kernels();

/// Leaves out everything past AVX2 (or SSE4) from now on, here and in bf16_kernels.h: for tests and
/// comparisons. Not while any encoder or renderer exists. oneDNN has its own variable,
/// ONEDNN_MAX_CPU_ISA.
void limit_kernels_to_avx2();
void limit_kernels_to_sse4();
void lift_kernel_limits();  ///< all that the processor has, again
bool kernels_limited();

/// Vectors of this many outputs do for layers of so few.
constexpr int kNarrowLanes = 8;

/// How many outputs a vector holds for a layer of so many.
int dot_lanes(int outputs);

/// How many numbers pack_weights writes.
std::size_t packed_size(int stretches, int length, int outputs, int lanes);
/// weight[s][k][o] = at(s, k, o) in the order dot_rows reads: blocks of two vectors of outputs,
/// then one of one vector; short vectors are filled with zeros.
template <typename At, typename Number>
void pack_weights(int stretches, int length, int outputs, int lanes, At at, Number* packed) {
    for (int first = 0; first < outputs;) {
        const int block = outputs - first > lanes ? 2 * lanes : lanes;
        for (int s = 0; s < stretches; ++s)
            for (int k = 0; k < length; ++k)
                for (int o = first; o < first + block; ++o)
                    *packed++ = o < outputs ? at(s, k, o) : Number{0};
        first += block;
    }
}

}  // namespace eventide
