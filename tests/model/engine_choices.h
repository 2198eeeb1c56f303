// The ways the fast engine can make its products, as far as this machine and program have them.
#pragma once

#include "src/model/engine.h"
#include "src/nn/backend.h"
#include "src/nn/onednn_conv.h"

#include <string>
#include <vector>

namespace eventide::test {

/// Options with which an engine is made, and what it then is called.
struct EngineChoice {
    std::string name;
    EngineOptions options;
    bool bf16 = false;
};

inline std::vector<EngineChoice> engine_choices() {
    const auto with = [](Precision precision, Kernels kernels, Instructions instructions) {
        return EngineOptions{
            .precision = precision, .kernels = kernels, .instructions = instructions};
    };
    EngineOptions emulated;
    emulated.emulate_bf16 = true;
    std::vector<EngineChoice> all{{"emulated bf16", emulated, true}};
    const VectorKernels* f32_before = nullptr;
    const Bf16Kernels* bf16_before = nullptr;
    for (const Instructions most : kAllInstructions) {
        const VectorKernels* f32 = &vector_kernels(most);
        if (f32 != f32_before)
            all.push_back({std::string{"own f32, "} + f32->name,
                           with(Precision::f32, Kernels::own, most), false});
        f32_before = f32;
        const Bf16Kernels* bf16 = bf16_kernels(most);
        if (bf16 != nullptr && bf16 != bf16_before)
            all.push_back({std::string{"own bf16, "} + bf16->name,
                           with(Precision::bf16, Kernels::own, most), true});
        bf16_before = bf16;
    }
    const Instructions best = Instructions::best;
    if (onednn_available())
        all.push_back({"oneDNN f32", with(Precision::f32, Kernels::onednn, best), false});
    if (onednn_has_bf16() && bf16_kernels() != nullptr)
        all.push_back({"oneDNN bf16", with(Precision::bf16, Kernels::onednn, best), true});
    return all;
}

}  // namespace eventide::test
