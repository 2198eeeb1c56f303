// Counts allocations of the whole process, on all threads, while asked to; or refuses large ones.
#pragma once

#include <cstddef>
#include <cstdint>

namespace eventide::test {

/// False under sanitizers, which bring their own malloc: tests that count then skip.
bool can_count_allocations();

/// Counts from construction to stop() or destruction; one at a time. Needs allocation_counter.cpp
/// in the program.
class AllocationCount {
public:
    AllocationCount();
    ~AllocationCount();
    AllocationCount(const AllocationCount&) = delete;
    AllocationCount& operator=(const AllocationCount&) = delete;

    std::int64_t stop();  ///< the number so far; counting ends
};

/// The same without an object, for counting between two moments on different threads.
void start_counting_allocations();
std::int64_t stop_counting_allocations();

/// From construction to destruction no thread is given so many bytes at once, or more. One at a
/// time, where allocations can be counted.
class MemoryShortage {
public:
    explicit MemoryShortage(std::size_t bytes);
    ~MemoryShortage();
    MemoryShortage(const MemoryShortage&) = delete;
    MemoryShortage& operator=(const MemoryShortage&) = delete;
};

}  // namespace eventide::test
