// Whether the BLAS under libtorch may be called from several threads at once.
#pragma once

namespace eventide {

/// OpenBLAS built for one thread (Debian's libopenblas0-serial, 0.3.21) now and then gives wrong
/// products when two threads call it. Throws Error(failed) where that one was loaded and more
/// threads than one will.
void require_blas_for_threads(int threads);

}  // namespace eventide
