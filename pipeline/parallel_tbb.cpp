// oneTBB behind ParallelFor.
#include "pipeline/parallel_tbb.h"

#include "src/core/error.h"

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
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
#else

/// Arenas by their number of threads.
using Arenas = std::multimap<int, tbb::task_arena>;

/// Those that nobody uses any more, for whoever wants one next: oneTBB keeps some kilobytes of each
/// that ends, for good.
class IdleArenas {
public:
    Arenas::node_type take(int threads) {
        {
            const std::lock_guard lock{mutex_};
            if (const auto found = arenas_.find(threads); found != arenas_.end())
                return arenas_.extract(found);
        }
        Arenas made;
        return made.extract(made.emplace(threads, threads));
    }
    void give_back(Arenas::node_type arena) {
        const std::lock_guard lock{mutex_};
        arenas_.insert(std::move(arena));
    }

private:
    std::mutex mutex_;
    Arenas arenas_;
};

IdleArenas& idle_arenas() {
    // Never ends: what is static in a program may give one back after everything of ours has ended.
    static IdleArenas& all = *new IdleArenas;
    return all;
}

/// One of our own: its number of threads holds here and is not set for the whole process.
class Arena {
public:
    explicit Arena(int threads) : arena_(idle_arenas().take(threads)) {}
    ~Arena() { idle_arenas().give_back(std::move(arena_)); }
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;

    template <typename Body>
    void execute(const Body& body) {
        arena_.mapped().execute(body);
    }

private:
    Arenas::node_type arena_;
};

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
    const auto arena = std::make_shared<Arena>(given);
    return [arena](int n, const std::function<void(int)>& body) {
        if (n == 1)
            body(0);
        else
            arena->execute([&] { tbb::parallel_for(0, n, body); });
    };
#endif
}

}  // namespace eventide
