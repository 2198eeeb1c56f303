// oneTBB behind ParallelFor.
#include "pipeline/parallel_tbb.h"

#include "src/core/error.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <memory>
#include <string>

namespace eventide {

ParallelFor parallel_for_with(int threads) {
    if (threads < 0)
        throw Error(ErrorKind::usage,
                    "threads: expected 0 (all) or more, found " + std::to_string(threads));
    if (threads == 1) return sequential_for;
    // An arena of our own: the number holds here and is not set for the whole process.
    const auto arena =
        std::make_shared<tbb::task_arena>(threads == 0 ? int(tbb::task_arena::automatic) : threads);
    return [arena](int n, const std::function<void(int)>& body) {
        if (n == 1)
            body(0);
        else
            arena->execute([&] { tbb::parallel_for(0, n, body); });
    };
}

}  // namespace eventide
