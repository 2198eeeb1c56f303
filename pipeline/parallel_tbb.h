// The ParallelFor that programs give to src/: oneTBB behind it.
#pragma once

#include "src/core/parallel_for.h"

namespace eventide {

/// As many threads as this process may use, whatever the machine has; at least 1.
int usable_threads();

/// At most `threads` threads at a time, the caller's included (1: no other thread is used; 0: as
/// many as this process may use; more than those are not made). May be called from several threads
/// at once: they share the threads. Throws Error (usage) for a negative number.
ParallelFor parallel_for_with(int threads);

}  // namespace eventide
