// Zeros that take no memory until they are touched.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>
#include <utility>

namespace eventide {

/// Scratch memory of one worker, whole pages: of a worker that no thread works in there are none.
class UntouchedZeros {
public:
    UntouchedZeros() = default;
    /// Throws std::bad_alloc.
    explicit UntouchedZeros(std::size_t numbers) : bytes_(numbers * sizeof(float)) {
        if (bytes_ == 0) return;
        void* const pages =
            mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (pages == MAP_FAILED) throw std::bad_alloc{};
        numbers_ = static_cast<float*>(pages);
    }
    ~UntouchedZeros() {
        if (numbers_ != nullptr) munmap(numbers_, bytes_);
    }
    UntouchedZeros(UntouchedZeros&& other) noexcept
        : bytes_(std::exchange(other.bytes_, 0)),
          numbers_(std::exchange(other.numbers_, nullptr)) {}
    UntouchedZeros& operator=(UntouchedZeros&& other) noexcept {
        std::swap(bytes_, other.bytes_);
        std::swap(numbers_, other.numbers_);
        return *this;
    }

    float* data() { return numbers_; }

private:
    std::size_t bytes_ = 0;
    float* numbers_ = nullptr;
};

}  // namespace eventide
