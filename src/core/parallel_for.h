// How src/ asks for data parallelism without owning a thread: whoever runs the program gives the
// means.
#pragma once

#include <functional>

namespace eventide {

/// Calls body(i) once for each 0 <= i < n, in any order and possibly at the same time on several
/// threads, and returns when all are done. Results must not depend on the order: work is cut by the
/// caller, never by the number of threads.
using ParallelFor = std::function<void(int n, const std::function<void(int)>& body)>;

/// One after the other, on the caller's thread.
inline void sequential_for(int n, const std::function<void(int)>& body) {
    for (int i = 0; i < n; ++i) body(i);
}

}  // namespace eventide
