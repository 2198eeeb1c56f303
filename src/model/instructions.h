// Which of the processor's instructions the fast engine may use: all, or as on an older processor.
#pragma once

namespace eventide {

/// avx512: with AVX512_BF16, without AMX.
enum class Instructions { best, avx512, avx2, sse4 };

/// Leaves out what is past `most` from now on (until it is called again), bfloat16 too where that
/// is below AVX-512, in our own kernels (oneDNN has its own variable, ONEDNN_MAX_CPU_ISA). For
/// comparisons; not while any encoder, renderer or Lpips exists: their weights are laid out for it.
void limit_instructions(Instructions most);

/// The same for a scope, and what held before afterwards, whatever happens.
class LimitedInstructions {
public:
    explicit LimitedInstructions(Instructions most);
    ~LimitedInstructions();
    LimitedInstructions(const LimitedInstructions&) = delete;
    LimitedInstructions& operator=(const LimitedInstructions&) = delete;

private:
    Instructions before_;
};

}  // namespace eventide
