// An owning, row-major two-dimensional array, 64-byte aligned: the pixels of a row are neighbours.
#pragma once

#include <cassert>
#include <cstddef>
#include <new>
#include <span>
#include <vector>

namespace eventide {

/// Gives vectors the alignment of a cache line, which the widest vector instructions like too.
template <typename T>
struct CacheLineAllocator {
    using value_type = T;
    static constexpr std::align_val_t kAlignment{64};

    CacheLineAllocator() = default;
    template <typename U>
    constexpr CacheLineAllocator(const CacheLineAllocator<U>&) noexcept {}
    T* allocate(std::size_t n) {
        return static_cast<T*>(::operator new(n * sizeof(T), kAlignment));
    }
    void deallocate(T* p, std::size_t) noexcept { ::operator delete(p, kAlignment); }
    friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};

/// [y][x], height before width. Indices are checked by assertions only.
template <typename T>
class Array2 {
public:
    Array2() = default;
    Array2(int height, int width)
        : height_(height), width_(width), values_(std::size_t(height) * std::size_t(width)) {}

    int height() const { return height_; }
    int width() const { return width_; }
    bool empty() const { return values_.empty(); }
    std::span<T> values() { return values_; }
    std::span<const T> values() const { return values_; }
    std::span<T> row(int y) { return values().subspan(begin_of(y), std::size_t(width_)); }
    std::span<const T> row(int y) const {
        return values().subspan(begin_of(y), std::size_t(width_));
    }
    T& operator()(int y, int x) { return values_[at(y, x)]; }
    const T& operator()(int y, int x) const { return values_[at(y, x)]; }

    friend bool operator==(const Array2&, const Array2&) = default;

private:
    std::size_t begin_of(int y) const {
        assert(y >= 0 && y < height_);
        return std::size_t(y) * std::size_t(width_);
    }
    std::size_t at(int y, int x) const {
        assert(x >= 0 && x < width_);
        return begin_of(y) + std::size_t(x);
    }
    int height_ = 0, width_ = 0;
    std::vector<T, CacheLineAllocator<T>> values_;
};

}  // namespace eventide
