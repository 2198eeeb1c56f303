// Which of the processor's instructions may be used: all, or as on an older processor.
#pragma once

namespace eventide {

/// avx512: with AVX512_BF16, without AMX. What the processor does not have is left out in any case.
enum class Instructions { best, avx512, avx2, sse4 };
constexpr Instructions kAllInstructions[] = {Instructions::best, Instructions::avx512,
                                             Instructions::avx2, Instructions::sse4};

}  // namespace eventide
