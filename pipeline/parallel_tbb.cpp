// oneTBB behind ParallelFor.
#include "pipeline/parallel_tbb.h"

#include "src/core/error.h"

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace eventide {

int usable_threads() {
    return tbb::info::default_concurrency();
}

namespace {

#ifdef __SANITIZE_THREAD__
/// The thread sanitizer does not see what oneTBB's library, not built with it, hands from thread to
/// thread. Under it each call has threads of its own, and all that our code does is watched.
ParallelFor watched_threads(int threads) {
    if (threads == 0) threads = usable_threads();
    return [threads](int n, const std::function<void(int)>& body) {
        std::atomic<int> next{0};
        const auto work = [&] {
            for (int i = next++; i < n; i = next++) body(i);
        };
        std::vector<std::jthread> others;
        for (int i = 1; i < std::min(threads, n); ++i) others.emplace_back(work);
        work();
    };
}
#endif

}  // namespace

ParallelFor parallel_for_with(int threads) {
    if (threads < 0)
        throw Error(ErrorKind::usage,
                    "threads: expected 0 (all) or more, found " + std::to_string(threads));
    if (threads == 1) return sequential_for;
#ifdef __SANITIZE_THREAD__
    return watched_threads(threads);
#else
    // As many as this process may use: for more, oneTBB writes a warning and gives no more.
    const int usable = usable_threads();
    const int given = threads == 0 ? usable : std::min(threads, usable);
    if (given == 1) return sequential_for;
    // An arena of our own: the number holds here and is not set for the whole process.
    const auto arena = std::make_shared<tbb::task_arena>(given);
    return [arena](int n, const std::function<void(int)>& body) {
        if (n == 1)
            body(0);
        else
            arena->execute([&] { tbb::parallel_for(0, n, body); });
    };
#endif
}

}  // namespace eventide
