// See instructions.h.
#include "src/model/instructions.h"

#include "src/kernels/vector_kernels.h"

#include <atomic>

namespace eventide {
namespace {

std::atomic<Instructions> limit{Instructions::best};

}  // namespace

void limit_instructions(Instructions most) {
    limit = most;
    if (most == Instructions::best) lift_kernel_limits();
    if (most == Instructions::avx512) limit_kernels_to_avx512();
    if (most == Instructions::avx2) limit_kernels_to_avx2();
    if (most == Instructions::sse4) limit_kernels_to_sse4();
}

LimitedInstructions::LimitedInstructions(Instructions most) : before_(limit) {
    limit_instructions(most);
}
LimitedInstructions::~LimitedInstructions() {
    limit_instructions(before_);
}

}  // namespace eventide
