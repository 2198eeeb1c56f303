// Reads flatbuffers that may be damaged: every offset is checked, nothing need be aligned.
#pragma once

#include "src/core/byte_order.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

namespace eventide {

/// A table inside a buffer; its fields are numbered in the order of the schema. A field that is
/// not there, or does not lie inside the buffer, gives the fallback.
class FlatTable {
public:
    /// Elements of one size, one after the other.
    struct Vector {
        std::span<const std::byte> bytes;
        std::size_t size = 0;
    };

    /// The table at byte `position`; empty when it or its vtable does not lie in the buffer.
    static std::optional<FlatTable> at(std::span<const std::byte> buffer, std::size_t position);

    template <typename T>
    T scalar(int field, T fallback = {}) const {
        const std::size_t place = place_of(field, sizeof(T));
        if (place == 0) return fallback;
        if constexpr (std::is_same_v<T, float>)
            return load_little_float(buffer_.data() + place);
        else
            return load_little<T>(buffer_.data() + place);
    }

    /// Where a struct stored in the table lies; null when it is not there.
    const std::byte* record(int field, std::size_t bytes) const {
        const std::size_t place = place_of(field, bytes);
        return place == 0 ? nullptr : buffer_.data() + place;
    }

    /// Empty when there is none or it does not lie in the buffer.
    std::optional<Vector> vector(int field, std::size_t element_bytes) const;
    std::optional<std::string_view> text(int field) const;

    /// Element i < tables.size of a vector(field, 4) of tables.
    std::optional<FlatTable> element(const Vector& tables, std::size_t i) const;

private:
    FlatTable() = default;
    std::size_t place_of(int field, std::size_t bytes) const;

    std::span<const std::byte> buffer_;
    std::size_t position_ = 0;                     ///< of the table
    std::size_t vtable_ = 0, vtable_entries_ = 0;  ///< position of the first entry, and how many
};

/// The root table of a size-prefixed buffer. Bytes after what the prefix says are ignored.
struct FlatRoot {
    std::string_view identifier;  ///< 4 characters
    FlatTable table;
};
std::optional<FlatRoot> read_flat_root(std::span<const std::byte> size_prefixed);

}  // namespace eventide
