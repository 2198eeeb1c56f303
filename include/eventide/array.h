/// @file
/// An owning, row-major two-dimensional array, 64-byte aligned: the pixels of a row are neighbours.
#pragma once

#include <cassert>
#include <cstddef>
#include <new>
#include <span>
#include <utility>
#include <vector>

namespace eventide {

/// Gives vectors the alignment of a cache line, which the widest vector instructions like too.
template <typename T>
struct CacheLineAllocator {
    using value_type = T;                              ///< as allocators have it
    static constexpr std::align_val_t kAlignment{64};  ///< bytes

    CacheLineAllocator() = default;
    /// All are alike, whatever they allocate.
    template <typename U>
    constexpr CacheLineAllocator(const CacheLineAllocator<U>&) noexcept {}
    /// Room for `n` values. Throws std::bad_alloc.
    T* allocate(std::size_t n) {
        return static_cast<T*>(::operator new(n * sizeof(T), kAlignment));
    }
    /// Frees what allocate() gave.
    void deallocate(T* p, std::size_t) noexcept { ::operator delete(p, kAlignment); }
    /// Always true: what one allocated any other may free.
    friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};

/// [y][x], height before width. Indices are checked by assertions only.
template <typename T>
class Array2 {
public:
    Array2() = default;
    /// Filled with zeros. Height and width: at least 0.
    Array2(int height, int width)
        : height_(height), width_(width), values_(std::size_t(height) * std::size_t(width)) {}
    Array2(const Array2&) = default;             ///< a copy of all values
    Array2& operator=(const Array2&) = default;  ///< a copy of all values
    /// `other` is empty afterwards.
    Array2(Array2&& other) noexcept { swap(other); }
    /// `other` is empty afterwards.
    Array2& operator=(Array2&& other) noexcept {
        Array2 taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~Array2() = default;
    /// Exchanges size and values.
    void swap(Array2& other) noexcept {
        std::swap(height_, other.height_);
        std::swap(width_, other.width_);
        values_.swap(other.values_);
    }

    int height() const { return height_; }                 ///< rows
    int width() const { return width_; }                   ///< columns
    bool empty() const { return values_.empty(); }         ///< no rows or no columns
    std::span<T> values() { return values_; }              ///< row by row
    std::span<const T> values() const { return values_; }  ///< row by row
    /// Row `y`, 0 to height() - 1.
    std::span<T> row(int y) { return values().subspan(begin_of(y), std::size_t(width_)); }
    /// Row `y`, 0 to height() - 1.
    std::span<const T> row(int y) const {
        return values().subspan(begin_of(y), std::size_t(width_));
    }
    /// The value in row `y` and column `x`.
    T& operator()(int y, int x) { return values_[at(y, x)]; }
    /// The value in row `y` and column `x`.
    const T& operator()(int y, int x) const { return values_[at(y, x)]; }

    friend bool operator==(const Array2&, const Array2&) = default;  ///< size and values

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
