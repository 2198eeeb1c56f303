// The sums of winograd.h for bf16 numbers, by AVX512_BF16.
#pragma once

#include "src/kernels/winograd.h"

namespace eventide::avx512_bf16 {

/// `channels` counts numbers, and is even. Positions are rounded once, when they are stored.
void winograd_input(const WinogradInput&);
/// Products are float32, what comes out bf16; `outputs` is even.
void winograd_output(const WinogradOutput&);

}  // namespace eventide::avx512_bf16
