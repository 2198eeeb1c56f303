// The fast kernels: one text over Highway's vectors, compiled for several instruction sets and
// chosen at run time. All take plain pointers; nothing is allocated.
#pragma once

#include "src/core/instructions.h"
#include "src/kernels/dot_area.h"
#include "src/kernels/render_kernels.h"
#include "src/kernels/winograd.h"

#include <cstddef>
#include <string>

namespace eventide {

/// Pixels x0 <= x < x1 of a row of up2 (docs/model.md), between two rows of samples: each the mean
/// of the samples around it, two above and two under.
/// out[x] = (above[x / 2] + under[x / 2] + above[x'] + under[x']) / 4, x' = min((x + 1) / 2, last)
struct DoubleRow {
    const void *above = nullptr, *under = nullptr;  ///< sample 0 of the rows
    int last = 0;                                   ///< sample of a row
    int x0 = 0, x1 = 0, channels = 0;
    void* out = nullptr;  ///< of pixel x0; pixels one after the other
};

struct VectorKernels {
    const char* name;  ///< of the instruction set
    int lanes;         ///< float32 numbers per vector
    bool by_quads;     ///< whether dot_area does layers of 8 and 16 outputs as quad_dots.h says
    /// The sums of DotArea, by fused multiply-adds so that AVX2 and AVX-512 agree.
    void (*dot_area)(const DotArea&);
    void (*winograd_input)(const WinogradInput&);
    void (*winograd_output)(const WinogradOutput&);
    /// out = sign(v) log1p(|v|). `ahead`: numbers from here to those wanted soon, which are fetched
    /// meanwhile; 0: none.
    void (*compress)(const float* in, float* out, std::size_t n, std::ptrdiff_t ahead);
    /// g <- sigmoid(g)
    void (*sigmoid)(float* g, std::size_t n);
    /// out = r h, for pixels of C channels; r so many numbers from one to the next.
    void (*reset_state)(const float* r, std::ptrdiff_t r_step, const float* h, float* out,
                        int channels, int pixels);
    /// out = h + u (tanh(c) - h), for pixels of C channels, all but u one after the other; c is
    /// overwritten.
    void (*update_state)(const float* h, const float* u, std::ptrdiff_t u_step, float* c,
                         float* out, int channels, int pixels);
    /// out = h + u (2 s - 1 - h), for pixels of C channels; of `halves` each has u_0 .. u_{C-1},
    /// s_0 .. s_{C-1}.
    void (*update_light)(const float* h, const float* halves, float* out, int channels, int pixels);
    /// out = relu(a + b)
    void (*add_relu)(const float* a, const float* b, float* out, std::size_t n);
    /// out = elu(a[c] scale[c] + shift[c] + skip), for n pixels of C channels; skip may be null
    void (*norm_elu)(const float* a, const float* scale, const float* shift, const float* skip,
                     float* out, std::size_t pixels, int channels);
    void (*elu)(const float* in, float* out, std::size_t n);
    void (*double_row)(const DoubleRow&);
    /// Whether |a - b| <= bound for each of n numbers; not where one is NaN.
    bool (*are_near)(const float* a, const float* b, float bound, std::size_t n);
    void (*offset_rows)(const OffsetRows&);
    void (*two_outputs)(const TwoOutputs&);
    /// False, and nothing done, for layers it is not made for.
    bool (*hidden_rows)(const HiddenRows&);
    void (*weigh_rows)(const WeighRows&);
    /// out = scale exp(in), |in| up to 40
    void (*scaled_exp)(const float* in, float scale, float* out, std::size_t n);
};

/// The best the processor has, up to `most`.
const VectorKernels& vector_kernels(Instructions most = Instructions::best);

/// Vectors of this many outputs do for layers of so few.
constexpr int kNarrowLanes = 8;

/// How many outputs a vector holds for a layer of so many.
int dot_lanes(const VectorKernels& kernels, int outputs);

/// How many numbers weights take, as dot_area reads them: [s][k][o] in blocks of two vectors of
/// outputs, then one of one vector; short vectors are filled with zeros.
std::size_t packed_size(int stretches, int length, int outputs, int lanes);

}  // namespace eventide
