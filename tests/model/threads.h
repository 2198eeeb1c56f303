// Data parallelism for tests: as many threads as asked for, made for each call.
#pragma once

#include "src/core/parallel_for.h"

#include <atomic>
#include <thread>
#include <vector>

namespace eventide::test {

inline ParallelFor with_threads(int threads) {
    return [threads](int n, const std::function<void(int)>& body) {
        std::atomic<int> next{0};
        const auto work = [&] {
            for (int i = next++; i < n; i = next++) body(i);
        };
        std::vector<std::thread> others;
        for (int i = 1; i < threads; ++i) others.emplace_back(work);
        work();
        for (std::thread& other : others) other.join();
    };
}

}  // namespace eventide::test
