#include "apps/train/blas.h"

#include "src/core/error.h"

#include <dlfcn.h>

#include <string>

namespace eventide {

void require_blas_for_threads(int threads) {
    if (threads <= 1) return;
    // OpenBLAS' own: 0 for a sequential build, 1 with threads, 2 with OpenMP.
    using ParallelKind = int();
    auto* kind = reinterpret_cast<ParallelKind*>(dlsym(RTLD_DEFAULT, "openblas_get_parallel"));
    if (kind != nullptr && kind() == 0)
        throw Error(ErrorKind::failed,
                    "--threads " + std::to_string(threads) +
                        ": expected a BLAS that several threads may call, found OpenBLAS built for "
                        "one: install libopenblas0-pthread in place of libopenblas0-serial, or "
                        "train with --threads 1");
}

}  // namespace eventide
