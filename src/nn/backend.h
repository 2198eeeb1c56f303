// What the fast layers compute by: with which numbers, which instructions, and whose code.
#pragma once

#include "src/kernels/bf16_kernels.h"
#include "src/kernels/vector_kernels.h"

#include <string>
#include <vector>

namespace eventide {

/// Chosen once, when an encoder or renderer is made, and the same for all its layers. The kernels
/// are tables that live as long as the process.
struct Backend {
    const VectorKernels* f32 = &vector_kernels();  ///< products of float32, and all but products
    const Bf16Kernels* bf16 = nullptr;             ///< products of bf16; null: all are of float32
    bool onednn = false;                           ///< 3x3 layers by oneDNN

    friend bool operator==(const Backend&, const Backend&) = default;
};

/// "AVX2", "bf16 (AVX512_BF16)", "bf16 (AMX)", "bf16 (emulated)", "bf16 (oneDNN, AMX)", ...
std::string name_of(const Backend& backend);
/// What encoders and renderers of the fast engine are called: "fast, AVX2", ...
std::string engine_name(const Backend& backend);

/// Every one that this processor and program have, older processors' included: our own kernels in
/// float32, in bf16 as there is and emulated; oneDNN's.
std::vector<Backend> all_backends();

/// What pays best here. In float32 our own kernels, by figures taken once and for all
/// (docs/model.md, "Arithmetic"); bf16 only where the processor has it and it is clearly quicker,
/// measured once per process, so that everything made in it agrees.
Backend fastest_backend(Instructions most, bool bf16_allowed, bool onednn_allowed);

}  // namespace eventide
