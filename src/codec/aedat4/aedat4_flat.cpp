// The layout of flatbuffers, from their published description ("FlatBuffers internals").
#include "src/codec/aedat4/aedat4_flat.h"

namespace eventide {

namespace {

bool holds(std::span<const std::byte> buffer, std::size_t position, std::size_t bytes) {
    return position <= buffer.size() && bytes <= buffer.size() - position;
}

}  // namespace

std::optional<FlatTable> FlatTable::at(std::span<const std::byte> buffer, std::size_t position) {
    if (!holds(buffer, position, 4)) return {};
    // A table begins with the distance back to its vtable, which may lie on either side.
    const auto back = std::int64_t(load_little<std::int32_t>(buffer.data() + position));
    const std::int64_t vtable = std::int64_t(position) - back;
    if (vtable < 0 || !holds(buffer, std::size_t(vtable), 4)) return {};
    const std::size_t vtable_bytes = load_little<std::uint16_t>(buffer.data() + vtable);
    if (vtable_bytes < 4 || !holds(buffer, std::size_t(vtable), vtable_bytes)) return {};
    FlatTable table;
    table.buffer_ = buffer;
    table.position_ = position;
    table.vtable_ = std::size_t(vtable) + 4;
    table.vtable_entries_ = (vtable_bytes - 4) / 2;
    return table;
}

std::size_t FlatTable::place_of(int field, std::size_t bytes) const {
    if (std::size_t(field) >= vtable_entries_) return 0;
    const std::size_t offset =
        load_little<std::uint16_t>(buffer_.data() + vtable_ + 2 * std::size_t(field));
    // The vtable also tells the table's size, but there are writers who put anything there.
    if (offset < 4 || !holds(buffer_, position_ + offset, bytes)) return 0;
    return position_ + offset;
}

std::optional<FlatTable::Vector> FlatTable::vector(int field, std::size_t element_bytes) const {
    const std::size_t place = place_of(field, 4);
    if (place == 0) return {};
    const std::size_t begin = place + load_little<std::uint32_t>(buffer_.data() + place);
    if (!holds(buffer_, begin, 4)) return {};
    const std::size_t size = load_little<std::uint32_t>(buffer_.data() + begin);
    if (!holds(buffer_, begin + 4, size * element_bytes)) return {};
    return Vector{buffer_.subspan(begin + 4, size * element_bytes), size};
}

std::optional<std::string_view> FlatTable::text(int field) const {
    const auto characters = vector(field, 1);
    if (!characters) return {};
    return std::string_view(reinterpret_cast<const char*>(characters->bytes.data()),
                            characters->size);
}

std::optional<FlatTable> FlatTable::element(const Vector& tables, std::size_t i) const {
    const std::byte* place = tables.bytes.data() + 4 * i;
    return at(buffer_, std::size_t(place - buffer_.data()) + load_little<std::uint32_t>(place));
}

std::optional<FlatRoot> read_flat_root(std::span<const std::byte> size_prefixed) {
    if (size_prefixed.size() < 12) return {};
    const std::size_t size = load_little<std::uint32_t>(size_prefixed.data());
    if (size < 8 || size > size_prefixed.size() - 4) return {};
    const auto buffer = size_prefixed.subspan(4, size);
    const auto table = FlatTable::at(buffer, load_little<std::uint32_t>(buffer.data()));
    if (!table) return {};
    return FlatRoot{{reinterpret_cast<const char*>(buffer.data()) + 4, 4}, *table};
}

}  // namespace eventide
