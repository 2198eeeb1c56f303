// The kernels of this processor, and of each older one that it can stand for.
#pragma once

#include "src/core/instructions.h"
#include "src/kernels/bf16_kernels.h"
#include "src/kernels/vector_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace eventide::test {

template <typename Kernels>
std::vector<const Kernels*> each_once(std::vector<const Kernels*> all) {
    std::vector<const Kernels*> found;
    for (const Kernels* kernels : all)
        if (kernels != nullptr && std::ranges::find(found, kernels) == found.end())
            found.push_back(kernels);
    return found;
}

inline std::vector<const VectorKernels*> all_vector_kernels() {
    std::vector<const VectorKernels*> all;
    for (const Instructions most : kAllInstructions) all.push_back(&vector_kernels(most));
    return each_once(all);
}

/// Runs `body` with the kernels of each instruction set.
template <typename Body>
void with_each(const Body& body) {
    for (const VectorKernels* kernels : all_vector_kernels()) {
        SCOPED_TRACE(kernels->name);
        body(*kernels);
    }
}

/// Without the emulated ones; none where the processor has no bf16 products.
inline std::vector<const Bf16Kernels*> all_bf16_kernels() {
    std::vector<const Bf16Kernels*> all;
    for (const Instructions most : kAllInstructions) all.push_back(bf16_kernels(most));
    return each_once(all);
}

}  // namespace eventide::test
