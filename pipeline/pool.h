// A fixed set of reusable buffers: the only thing in the pipeline that bounds memory and latency.
#pragma once

#include <concurrentqueue.h>
#include <lightweightsemaphore.h>

#include <cassert>
#include <cstddef>
#include <memory>
#include <thread>
#include <vector>

namespace eventide {

/// Lends out buffers made once at construction. Whoever holds a Handle owns the buffer;
/// destroying the Handle gives it back.
///
/// Thread: acquire() and try_acquire() from one thread; a Handle may die on any thread.
template <typename T>
class Pool {
public:
    struct GiveBack {
        Pool* home = nullptr;
        void operator()(T* buffer) const { home->give_back(buffer); }
    };
    using Handle = std::unique_ptr<T, GiveBack>;

    /// `make()` gives one buffer as a value.
    template <typename Make>
    Pool(std::size_t size, Make make) : free_(size, 0, kThreadsThatGiveBack) {
        buffers_.reserve(size);
        for (std::size_t i = 0; i < size; ++i) {
            buffers_.push_back(std::make_unique<T>(make()));
            give_back(buffers_.back().get());
        }
    }
    Pool(const Pool&) = delete;
    Pool& operator=(const Pool&) = delete;
    ~Pool() { assert(free_.size_approx() == buffers_.size() && "a buffer outlived its pool"); }

    /// Waits for a buffer. Nothing is ever lost, and the caller slows down to the pace downstream.
    Handle acquire() {
        available_.wait();
        return take();
    }

    /// Never waits. Empty when every buffer is lent out: the caller decides what to lose.
    Handle try_acquire() { return available_.tryWait() ? take() : Handle{}; }

    std::size_t size() const { return buffers_.size(); }

    /// About how many are lent out; no fewer, to the thread that acquires.
    std::size_t lent() const { return buffers_.size() - available_.availableApprox(); }

private:
    Handle take() {
        T* buffer = nullptr;
        while (!free_.try_dequeue(buffer))
            std::this_thread::yield();  // counted in, so about to show
        return Handle{buffer, GiveBack{this}};
    }
    void give_back(T* buffer) {
        free_.enqueue(buffer);
        available_.signal();
    }

    /// Pre-sizes free_ for threads that push without a token; without it a push allocates now and
    /// then. Maker, producer, consumer, and whoever empties a link after an error.
    static constexpr std::size_t kThreadsThatGiveBack = 4;
    /// The library's 10000 would keep a core busy for every waiting stage.
    static constexpr int kSpinsBeforeSleep = 100;
    std::vector<std::unique_ptr<T>> buffers_;
    moodycamel::ConcurrentQueue<T*> free_;
    moodycamel::LightweightSemaphore available_{0, kSpinsBeforeSleep};
};

}  // namespace eventide
