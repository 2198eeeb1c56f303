// The ways the fast engine can make its products, as far as this machine and program have them.
#pragma once

#include "src/model/engine.h"
#include "src/nn/arithmetic.h"
#include "src/nn/onednn_conv.h"

#include <string>
#include <vector>

namespace eventide::test {

struct Backend {
    std::string name;
    EngineOptions options;
    bool bf16 = false;
};

inline std::vector<Backend> backends() {
    const auto with = [](Precision precision, Kernels kernels) {
        EngineOptions options;
        options.precision = precision;
        options.kernels = kernels;
        return options;
    };
    EngineOptions emulated;
    emulated.emulate_bf16 = true;
    std::vector<Backend> all{{"own f32", with(Precision::f32, Kernels::own), false},
                             {"emulated bf16", emulated, true}};
    if (onednn_available())
        all.push_back({"oneDNN f32", with(Precision::f32, Kernels::onednn), false});
    if (bf16_available()) all.push_back({"own bf16", with(Precision::bf16, Kernels::own), true});
    if (bf16_available() && onednn_has_bf16())
        all.push_back({"oneDNN bf16", with(Precision::bf16, Kernels::onednn), true});
    return all;
}

}  // namespace eventide::test
