// What precisions and kernels are called, in programs, C, Python and files.
#pragma once

#include "src/core/words.h"

#include <eventide/arithmetic.h>

#include <vector>

namespace eventide {

inline const std::vector<Word<Precision>> kPrecisionWords{
    {Precision::automatic, "auto"}, {Precision::f32, "f32"}, {Precision::bf16, "bf16"}};
inline const std::vector<Word<Kernels>> kKernelWords{
    {Kernels::automatic, "auto"}, {Kernels::own, "own"}, {Kernels::onednn, "onednn"}};

}  // namespace eventide
