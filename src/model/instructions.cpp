#include "src/model/instructions.h"

#include "src/kernels/vector_kernels.h"

namespace eventide {

void limit_instructions(Instructions most) {
    if (most == Instructions::best) lift_kernel_limits();
    if (most == Instructions::avx512) limit_kernels_to_avx512();
    if (most == Instructions::avx2) limit_kernels_to_avx2();
    if (most == Instructions::sse4) limit_kernels_to_sse4();
}

}  // namespace eventide
