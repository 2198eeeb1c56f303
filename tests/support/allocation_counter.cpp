// Stands before glibc's malloc, counts, and refuses.
#include "tests/support/allocation_counter.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define EVENTIDE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define EVENTIDE_SANITIZED 1
#endif
#endif

namespace {

std::atomic<std::int64_t> allocations{0};
std::atomic<bool> counting{false};
std::atomic<std::size_t> too_many_bytes{SIZE_MAX};

}  // namespace

#if !defined(EVENTIDE_SANITIZED) && defined(__GLIBC__)

namespace {
/// Whether there is memory for n bytes.
bool count(std::size_t n) {
    if (counting.load(std::memory_order_relaxed))
        allocations.fetch_add(1, std::memory_order_relaxed);
    return n < too_many_bytes.load(std::memory_order_relaxed);
}
}  // namespace

// operator new ends here, too.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t n) {
    return count(n) ? __libc_malloc(n) : nullptr;
}
void* calloc(std::size_t n, std::size_t size) {
    return count(n * size) ? __libc_calloc(n, size) : nullptr;
}
void* realloc(void* p, std::size_t n) {
    return count(n) ? __libc_realloc(p, n) : nullptr;
}
void* memalign(std::size_t alignment, std::size_t n) {
    return count(n) ? __libc_memalign(alignment, n) : nullptr;
}
void* aligned_alloc(std::size_t alignment, std::size_t n) {
    return memalign(alignment, n);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t n) {
    *p = memalign(alignment, n);
    return *p == nullptr ? ENOMEM : 0;
}
}

bool eventide::test::can_count_allocations() {
    return true;
}

#else

bool eventide::test::can_count_allocations() {
    return false;
}

#endif

namespace eventide::test {

void start_counting_allocations() {
    allocations = 0;
    counting = true;
}

std::int64_t stop_counting_allocations() {
    counting = false;
    return allocations;
}

AllocationCount::AllocationCount() {
    start_counting_allocations();
}

AllocationCount::~AllocationCount() {
    stop_counting_allocations();
}

std::int64_t AllocationCount::stop() {
    return stop_counting_allocations();
}

MemoryShortage::MemoryShortage(std::size_t bytes) {
    too_many_bytes = bytes;
}

MemoryShortage::~MemoryShortage() {
    too_many_bytes = SIZE_MAX;
}

}  // namespace eventide::test
