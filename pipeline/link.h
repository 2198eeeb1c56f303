// An ordered hand-over between exactly two threads.
#pragma once

#include <concurrentqueue.h>
#include <lightweightsemaphore.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <thread>
#include <utility>

namespace eventide {

/// One thread pushes, one other thread pops, and items arrive in the order they were pushed.
///
/// ConcurrentQueue keeps order only per producer, so there is one producer token; its capacity
/// is a minimum and not a bound, so a Link has no bound: what it carries comes from a Pool.
template <typename T>
class Link {
public:
    explicit Link(std::size_t expected) : queue_(expected, 1, 0), producer_(queue_) {}

    /// Producer thread. Never waits.
    void push(T item) {
        queue_.enqueue(producer_, std::move(item));
        ++pushed_;
        items_.signal();
    }

    /// Producer thread, once, after the last push: the end of the stream travels in the stream.
    void close() {
        total_.store(pushed_, std::memory_order_release);
        items_.signal();
    }

    /// Consumer thread. Waits; empty after close() and the last item, and ever after.
    std::optional<T> pop() {
        if (popped_ == total_.load(std::memory_order_acquire)) return std::nullopt;
        items_.wait();
        // Every signal but the last stands for an item.
        if (popped_ == total_.load(std::memory_order_acquire)) return std::nullopt;
        T item;
        while (!queue_.try_dequeue_from_producer(producer_, item))
            std::this_thread::yield();  // counted in, so about to show
        ++popped_;
        return item;
    }

    /// Any thread: about how many items wait.
    std::size_t waiting() const { return queue_.size_approx(); }

private:
    static constexpr int kSpinsBeforeSleep = 100;       // see Pool
    static constexpr std::uint64_t kOpen = UINT64_MAX;  // nobody pushes that many
    moodycamel::ConcurrentQueue<T> queue_;
    moodycamel::ProducerToken producer_;
    moodycamel::LightweightSemaphore items_{0, kSpinsBeforeSleep};
    std::uint64_t pushed_ = 0;  // producer thread
    std::uint64_t popped_ = 0;  // consumer thread
    std::atomic<std::uint64_t> total_{kOpen};
};

}  // namespace eventide
