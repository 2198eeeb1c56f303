// FTAB: a flatbuffer of {offset, {stream, bytes}, elements, first and last time}.
#include "src/codec/aedat4_table.h"

#include "src/codec/aedat4.h"
#include "src/codec/aedat4_flat.h"
#include "src/codec/aedat4_flat_writer.h"
#include "src/codec/byte_order.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace eventide {

namespace {

constexpr std::size_t kPacketHeaderBytes = 8;
constexpr std::size_t kChunkBytes = std::size_t(1) << 20;

template <typename T>
void widen(const std::vector<T>& items, std::optional<std::pair<SensorTime, SensorTime>>& span) {
    for (const T& item : items) {
        if (!span) span.emplace(item.t, item.t);
        span->first = std::min(span->first, item.t);
        span->second = std::max(span->second, item.t);
    }
}

/// One packet's entry, from its own data.
Aedat4TableEntry entry_of(const Aedat4Header& header, std::uint64_t position,
                          std::span<const std::byte> packet) {
    Aedat4TableEntry entry;
    entry.position = position + kPacketHeaderBytes;
    entry.stream = load_little<std::int32_t>(packet.data());
    entry.bytes = load_little<std::int32_t>(packet.data() + 4);
    Aedat4Parser parser(header, 0, 0);
    Batch batch;
    parser.parse(packet, batch);
    parser.finish(batch);
    std::optional<std::pair<SensorTime, SensorTime>> span;
    widen(batch.events, span);
    widen(batch.images, span);
    widen(batch.imu, span);
    widen(batch.triggers, span);
    entry.elements = std::int64_t(batch.events.size() + batch.images.size() + batch.imu.size() +
                                  batch.triggers.size());
    if (span) std::tie(entry.first, entry.last) = *span;
    return entry;
}

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

/// Hops from packet to packet; ends where none begins.
Aedat4Table scan(const Aedat4Header& header, const ReadAt& read_at) {
    Aedat4Table table;
    std::vector<std::byte> packet;
    for (std::uint64_t position = header.stream.data_offset;;) {
        packet.resize(kPacketHeaderBytes);
        if (read_at(position, packet) < kPacketHeaderBytes) break;
        const auto bytes = load_little<std::int32_t>(packet.data() + 4);
        const auto stream = load_little<std::int32_t>(packet.data());
        const bool known = std::any_of(header.streams.begin(), header.streams.end(),
                                       [&](const Aedat4Stream& s) { return s.id == stream; });
        if (!known || bytes <= 0 || std::size_t(bytes) > kLargestAedat4Packet) break;
        // In steps, so that a size that lies takes no more memory than there are bytes.
        bool whole = true;
        for (std::size_t left = std::size_t(bytes); whole && left > 0;) {
            const std::size_t n = std::min(left, kChunkBytes), begin = packet.size();
            packet.resize(begin + n);
            whole = read_at(position + begin, std::span(packet).subspan(begin)) == n;
            left -= n;
        }
        if (!whole) break;
        table.entries.push_back(entry_of(header, position, packet));
        position += packet.size();
    }
    return table;
}

}  // namespace

bool Aedat4Table::has_times() const {
    return std::all_of(entries.begin(), entries.end(), [](const Aedat4TableEntry& entry) {
        return entry.last != SensorTime{} && entry.first <= entry.last;
    });
}

std::uint64_t Aedat4Table::position_for(SensorTime t) const {
    const auto found = std::find_if(entries.begin(), entries.end(),
                                    [&](const Aedat4TableEntry& entry) { return entry.last >= t; });
    if (found != entries.end()) return found->position - kPacketHeaderBytes;
    if (entries.empty()) return 0;
    return entries.back().position + std::uint64_t(entries.back().bytes);
}

std::optional<Aedat4Table> read_aedat4_table(std::span<const std::byte> bytes) {
    Aedat4Unpacker unpacker;
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

Aedat4FileTable load_aedat4_table(const Aedat4Header& header, const ReadAt& read_at) {
    if (auto table = read_at_end(header, read_at); table && table->has_times())
        return {std::move(*table), false};
    return {scan(header, read_at), true};
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
