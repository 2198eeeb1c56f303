// 3x3 convolutions by oneDNN, one primitive per size of region, run on the caller's thread alone.
#pragma once

#include "src/kernels/bf16_kernels.h"
#include "src/kernels/plain/conv.h"
#include "src/nn/tiling.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace eventide {

/// Where a convolution reads and writes: `in` is the pixel up and left of the first output's
/// centre.
struct ConvCall {
    const float* in = nullptr;
    std::ptrdiff_t in_pitch = 0;  ///< numbers from one row to the next
    float* out = nullptr;
    std::ptrdiff_t out_pitch = 0;  ///< likewise; pixels lie dense
    int height = 0, width = 0;     ///< outputs
    /// The whole input, where it lies dense in the numbers that are multiplied; `in` is not read
    /// then.
    const void* gathered = nullptr;
};

/// Whether this program was built with oneDNN; and whether oneDNN multiplies bf16 numbers on this
/// processor (AVX512_BF16), and by AMX, as far as ONEDNN_MAX_CPU_ISA allows.
bool onednn_available();
bool onednn_has_bf16();
bool onednn_has_amx();

/// oneDNN wants dense blocks whose size is known when the primitive is made. So a region's input is
/// gathered into scratch memory (and made bf16 on the way), and what comes out is put where
/// it belongs; both are left out where the memory is dense already. Every call makes a few small
/// allocations inside oneDNN, which keeps its argument lists on the heap.
class OnednnConv {
public:
    /// `bf16`: makes inputs bf16, and products are of bf16; null: of float32. run() may be called
    /// for regions of these extents. Throws Error(usage) where oneDNN is not there.
    OnednnConv(const plain::ConvWeights<float>& weights, int stride, bool relu,
               const Bf16Kernels* bf16, std::vector<Extent> extents);
    ~OnednnConv();

    /// Numbers of 4 bytes that run() needs for any of the extents.
    std::size_t scratch_size() const;
    /// On any number of threads, each with its own scratch memory.
    // NOLINTNEXTLINE(bugprone-exception-escape)
    void run(const ConvCall& call, float* scratch) const noexcept;

private:
    struct Primitives;
    std::unique_ptr<const Primitives> primitives_;
};

}  // namespace eventide
