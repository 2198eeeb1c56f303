// A number that one thread counts up and others look at.
#pragma once

#include <atomic>
#include <cstdint>

namespace eventide {

/// Counted by one thread, read by any.
class Counter {
public:
    void add(std::uint64_t n = 1) noexcept { set(value() + n); }
    void set(std::uint64_t n) noexcept { value_.store(n, std::memory_order_relaxed); }
    std::uint64_t value() const noexcept { return value_.load(std::memory_order_relaxed); }

private:
    std::atomic<std::uint64_t> value_{0};
};

}  // namespace eventide
