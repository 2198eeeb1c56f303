// With which numbers and by whom the fast layers make their products.
#pragma once

#include <string>

namespace eventide {

enum class Products {
    f32,
    bf16,           ///< by the processor's own bf16 products
    bf16_emulated,  ///< the same numbers on any processor, slowly: for judging bf16 without one
};

/// Everything of one encoder or renderer uses the same.
struct Arithmetic {
    Products products = Products::f32;
    bool onednn = false;  ///< convolutions by oneDNN, else by our own kernels

    bool bf16() const { return products != Products::f32; }
    friend bool operator==(const Arithmetic&, const Arithmetic&) = default;
};

/// "AVX2", "bf16 (AVX512_BF16)", "bf16 (AMX)", "bf16 (oneDNN, AMX)", ...
const char* name_of(const Arithmetic& arithmetic);
/// What encoders and renderers of the fast engine are called: "fast, AVX2", ...
std::string engine_name(const Arithmetic& arithmetic);

/// Whether this processor has bf16 products, and our kernels use them.
bool bf16_available();
/// Whether they are AMX'.
bool amx_available();
/// What pays best here. In float32 our own kernels, by figures taken once and for all
/// (docs/model.md, "Arithmetic"); bf16 only where the processor has it and it is clearly quicker,
/// measured once per process, so that everything made in it agrees.
Arithmetic best_arithmetic(bool bf16_allowed, bool onednn_allowed);

}  // namespace eventide
