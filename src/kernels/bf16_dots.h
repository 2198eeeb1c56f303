// Sums of products of bf16 pairs, by AVX512_BF16.
#pragma once

#include "src/kernels/dot_area.h"

namespace eventide::avx512_bf16 {

/// As Bf16Kernels::dot_area.
void dot_area(const DotArea&);

}  // namespace eventide::avx512_bf16
