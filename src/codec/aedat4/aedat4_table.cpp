// FTAB: a flatbuffer of {offset, {stream, bytes}, elements, first and last time}.
#include "src/codec/aedat4/aedat4_table.h"

#include "src/codec/aedat4/aedat4_compression.h"
#include "src/codec/aedat4/aedat4_flat.h"
#include "src/codec/aedat4/aedat4_flat_writer.h"
#include "src/core/byte_order.h"

#include <algorithm>
#include <array>
#include <utility>

namespace eventide {

namespace {

constexpr std::size_t kPacketHeaderBytes = 8;
constexpr std::size_t kChunkBytes = std::size_t(1) << 20;

std::optional<Aedat4Table> read_at_end(const Aedat4Header& header, const ReadAt& read_at) {
    if (header.table_position <= 0) return {};
    std::vector<std::byte> bytes;
    for (std::size_t n = kChunkBytes; n == kChunkBytes && bytes.size() < kLargestAedat4Packet;) {
        const std::size_t begin = bytes.size();
        bytes.resize(begin + kChunkBytes);
        n = read_at(std::uint64_t(header.table_position) + begin, std::span(bytes).subspan(begin));
        bytes.resize(begin + n);
    }
    return read_aedat4_table(bytes);
}

/// Whether a packet of this entry's stream and size begins where the entry says.
bool fits(const Aedat4TableEntry& entry, const ReadAt& read_at) {
    std::array<std::byte, kPacketHeaderBytes> header{};
    return read_at(entry.position - kPacketHeaderBytes, header) == header.size() &&
           load_little<std::int32_t>(header.data()) == entry.stream &&
           load_little<std::int32_t>(header.data() + 4) == entry.bytes;
}

}  // namespace

bool Aedat4Table::has_times() const {
    return std::all_of(entries.begin(), entries.end(), [](const Aedat4TableEntry& entry) {
        return entry.last != SensorTime{} && entry.first <= entry.last;
    });
}

std::optional<Aedat4Table> read_aedat4_table(std::span<const std::byte> bytes,
                                             std::size_t largest) {
    Aedat4Unpacker unpacker{largest};
    const auto unpacked = unpacker.unpack(bytes);
    const auto root = unpacked ? read_flat_root(*unpacked) : std::nullopt;
    if (!root || root->identifier != "FTAB") return {};
    const auto records = root->table.vector(0, 4);
    if (!records) return {};
    Aedat4Table table;
    table.entries.reserve(records->size);
    for (std::size_t i = 0; i < records->size; ++i) {
        const auto record = root->table.element(*records, i);
        const std::byte* packet = record ? record->record(1, 8) : nullptr;
        if (!packet) return {};
        const auto position = record->scalar<std::int64_t>(0);
        const auto size = load_little<std::int32_t>(packet + 4);
        if (position < std::int64_t(kPacketHeaderBytes) || size < 0) return {};
        table.entries.push_back({std::uint64_t(position), load_little<std::int32_t>(packet), size,
                                 record->scalar<std::int64_t>(2),
                                 from_us(record->scalar<std::int64_t>(3)),
                                 from_us(record->scalar<std::int64_t>(4))});
    }
    return table;
}

std::optional<std::uint64_t> find_in_aedat4_table(const Aedat4Header& header, const ReadAt& read_at,
                                                  SensorTime t) {
    const auto table = read_at_end(header, read_at);
    if (!table || table->entries.empty() || !table->has_times()) return {};
    // Streams take turns in the file, so the first in it need not be the first in the table.
    const Aedat4TableEntry* found = nullptr;
    for (const Aedat4TableEntry& entry : table->entries)
        if (entry.last >= t && (!found || entry.position < found->position)) found = &entry;
    const Aedat4TableEntry& entry = found ? *found : table->entries.back();
    if (!fits(table->entries.front(), read_at) || !fits(entry, read_at)) return {};
    return entry.position - kPacketHeaderBytes;
}

std::vector<std::byte> aedat4_table_bytes(const Aedat4Table& table, Aedat4Compression compression) {
    FlatWriter flat("FTAB", {4});
    const std::size_t list = flat.begin_vector(flat.root(), 0, table.entries.size(), 4, 4);
    for (std::size_t i = 0; i < table.entries.size(); ++i) {
        const Aedat4TableEntry& entry = table.entries[i];
        const auto at = flat.begin_table({8, 8, 8, 8, 8}, list + 4 * i);
        flat.set(at, 0, std::int64_t(entry.position));
        flat.set(at, 1,
                 std::uint64_t(std::uint32_t(entry.stream)) |
                     std::uint64_t(std::uint32_t(entry.bytes)) << 32);
        flat.set(at, 2, entry.elements);
        flat.set(at, 3, to_us(entry.first));
        flat.set(at, 4, to_us(entry.last));
    }
    std::vector<std::byte> out;
    pack_aedat4(flat.bytes(), compression, out);
    return out;
}

}  // namespace eventide
