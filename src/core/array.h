// Owning, row-major blocks of numbers, 64-byte aligned; the last index is contiguous. Array2 is in
// the public header.
#pragma once

#include <eventide/array.h>

#include <sys/mman.h>

#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <utility>
#include <vector>

namespace eventide {

/// As CacheLineAllocator; large blocks in huge pages, as far as they fill them and the system has
/// some: a tile's rows lie a page or more apart, and a core remembers where only so many pages are.
template <typename T>
struct HugePageAllocator : CacheLineAllocator<T> {
    using value_type = T;
    static constexpr std::size_t kPage = std::size_t{1} << 21;

    HugePageAllocator() = default;
    template <typename U>
    constexpr HugePageAllocator(const HugePageAllocator<U>&) noexcept {}
    /// Room for `n` values. Throws std::bad_alloc.
    T* allocate(std::size_t n) {
        const std::size_t bytes = n * sizeof(T);
        if (bytes < kPage) return CacheLineAllocator<T>::allocate(n);
        void* const pages = ::operator new (bytes, std::align_val_t{kPage});
        // The rest stays in small ones, so that no memory is used up for nothing. A refusal leaves
        // everything as it is.
        ::madvise(pages, bytes / kPage * kPage, MADV_HUGEPAGE);
        return static_cast<T*>(pages);
    }
    void deallocate(T* p, std::size_t n) noexcept {
        if (n * sizeof(T) < kPage)
            CacheLineAllocator<T>::deallocate(p, n);
        else
            ::operator delete (p, std::align_val_t{kPage});
    }
    friend bool operator==(const HugePageAllocator&, const HugePageAllocator&) { return true; }
};

/// [y][x][channel]: all numbers of one pixel are neighbours ("channels last"), because every
/// consumer of a voxel grid, a feature map or a latent map reads whole pixels.
template <typename T>
class Array3 {
public:
    Array3() = default;
    Array3(int height, int width, int channels)
        : height_(height),
          width_(width),
          channels_(channels),
          values_(std::size_t(height) * std::size_t(width) * std::size_t(channels)) {}
    Array3(const Array3&) = default;
    Array3& operator=(const Array3&) = default;
    Array3(Array3&& other) noexcept { swap(other); }  ///< `other` is empty afterwards
    Array3& operator=(Array3&& other) noexcept {      ///< the same
        Array3 taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~Array3() = default;
    void swap(Array3& other) noexcept {
        std::swap(height_, other.height_);
        std::swap(width_, other.width_);
        std::swap(channels_, other.channels_);
        values_.swap(other.values_);
    }

    int height() const { return height_; }
    int width() const { return width_; }
    int channels() const { return channels_; }
    bool empty() const { return values_.empty(); }
    std::span<T> values() { return values_; }
    std::span<const T> values() const { return values_; }
    std::span<T> pixel(int y, int x) { return values().subspan(at(y, x), std::size_t(channels_)); }
    std::span<const T> pixel(int y, int x) const {
        return values().subspan(at(y, x), std::size_t(channels_));
    }
    T& operator()(int y, int x, int c) { return values_[at(y, x) + std::size_t(c)]; }
    const T& operator()(int y, int x, int c) const { return values_[at(y, x) + std::size_t(c)]; }

    friend bool operator==(const Array3&, const Array3&) = default;

private:
    std::size_t at(int y, int x) const {
        assert(y >= 0 && y < height_ && x >= 0 && x < width_);
        return (std::size_t(y) * std::size_t(width_) + std::size_t(x)) * std::size_t(channels_);
    }
    int height_ = 0, width_ = 0, channels_ = 0;
    std::vector<T, HugePageAllocator<T>> values_;
};

/// No NaN, no infinity.
inline bool is_finite(const Array2<float>& map) {
    // Their exponents, all ones, carry one step further into the sign's place. Neither branches
    // nor comparisons: compilers make vectors of it.
    constexpr std::uint32_t kWithoutSign = 0x7FFF'FFFF, kStep = 0x0080'0000;
    std::uint32_t carried = 0;
    for (const float value : map.values())
        carried |= (std::bit_cast<std::uint32_t>(value) & kWithoutSign) + kStep;
    return (carried & ~kWithoutSign) == 0;
}

}  // namespace eventide
