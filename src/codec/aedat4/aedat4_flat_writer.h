// Writes size-prefixed flatbuffers front to back: tables, vectors, texts.
#pragma once

#include "src/core/byte_order.h"

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

namespace eventide {

/// Everything is aligned to its size, counted from the size prefix, as strict readers demand.
class FlatWriter {
public:
    static constexpr std::size_t kMaxFields = 16;

    /// Where a table and its fields lie.
    struct Table {
        std::size_t position = 0;
        std::array<std::size_t, kMaxFields> fields{};
    };

    /// Begins a buffer with its root table, whose fields have these sizes in bytes (4 for vectors,
    /// texts and tables).
    FlatWriter(std::string_view identifier, std::initializer_list<std::size_t> root_fields) {
        append_zeros(8);
        for (const char c : identifier) bytes_.push_back(std::byte(c));
        root_ = begin_table(root_fields, 4);
    }

    const Table& root() const { return root_; }

    /// A table that the 4 bytes at `reference` point to; its fields are zero.
    Table begin_table(std::initializer_list<std::size_t> field_bytes, std::size_t reference) {
        assert(field_bytes.size() <= kMaxFields);
        const std::size_t vtable_bytes = 4 + 2 * field_bytes.size();
        // The first field follows the table's first 4 bytes and may be 8 bytes wide.
        align(bytes_.size() + vtable_bytes, 8, 4);
        Table table;
        table.position = bytes_.size() + vtable_bytes;
        append_little(bytes_, std::uint16_t(vtable_bytes));
        const std::size_t size_place = bytes_.size();
        append_little(bytes_, std::uint16_t(0));
        std::size_t end = table.position + 4, i = 0;
        for (const std::size_t size : field_bytes) {
            end = (end + size - 1) / size * size;
            append_little(bytes_, std::uint16_t(end - table.position));
            table.fields[i++] = end;
            end += size;
        }
        put(size_place, std::uint16_t(end - table.position));
        append_little(bytes_, std::int32_t(vtable_bytes));
        append_zeros(end - bytes_.size());
        refer(reference, table.position);
        return table;
    }

    template <typename T>
    void set(const Table& table, int field, T value) {
        put(table.fields[std::size_t(field)], value);
    }
    void set(const Table& table, int field, float value) {
        put(table.fields[std::size_t(field)], std::bit_cast<std::uint32_t>(value));
    }

    /// A vector of zeros; the result is where its first element lies.
    std::size_t begin_vector(const Table& table, int field, std::size_t n,
                             std::size_t element_bytes, std::size_t alignment) {
        align(bytes_.size() + 4, alignment, 0);
        refer(table.fields[std::size_t(field)], bytes_.size());
        append_little(bytes_, std::uint32_t(n));
        const std::size_t first = bytes_.size();
        append_zeros(n * element_bytes);
        return first;
    }

    void set_text(const Table& table, int field, std::string_view text) {
        const std::size_t first = begin_vector(table, field, text.size(), 1, 4);
        for (std::size_t i = 0; i < text.size(); ++i) bytes_[first + i] = std::byte(text[i]);
        bytes_.push_back(std::byte{0});
    }

    template <typename T>
    void put(std::size_t position, T value) {
        using Bits = std::make_unsigned_t<T>;
        for (std::size_t i = 0; i < sizeof(T); ++i)
            bytes_[position + i] = std::byte(std::uint64_t(Bits(value)) >> (8 * i) & 0xFF);
    }

    /// The whole buffer, with its size in front.
    std::span<const std::byte> bytes() {
        align(bytes_.size(), 8, 0);
        put(0, std::uint32_t(bytes_.size() - 4));
        return bytes_;
    }

private:
    void append_zeros(std::size_t n) { bytes_.resize(bytes_.size() + n); }
    /// Appends until `position`, which moves along, is `rest` beyond a multiple of `alignment`.
    void align(std::size_t position, std::size_t alignment, std::size_t rest) {
        for (; position % alignment != rest; ++position) bytes_.push_back(std::byte{0});
    }
    void refer(std::size_t from, std::size_t to) { put(from, std::uint32_t(to - from)); }

    std::vector<std::byte> bytes_;
    Table root_;
};

}  // namespace eventide
