// The table at the end of an AEDAT4 file: where each packet lies and which times it holds.
#pragma once

#include "src/codec/aedat4/aedat4_compression.h"
#include "src/codec/aedat4/aedat4_header.h"
#include "src/core/sensor_time.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace eventide {

struct Aedat4TableEntry {
    std::uint64_t position = 0;  ///< of the packet's payload in the file, 8 bytes after its header
    std::int32_t stream = 0;
    std::int32_t bytes = 0;     ///< of the payload
    std::int64_t elements = 0;  ///< 0 where the writer did not say
    SensorTime first{}, last{};
};

struct Aedat4Table {
    std::vector<Aedat4TableEntry> entries;  ///< in the order of the file

    /// Some writers leave the times out.
    bool has_times() const;
};

/// The table from its (packed) bytes; empty when they are damaged, or more than `largest` unpacked.
std::optional<Aedat4Table> read_aedat4_table(std::span<const std::byte> bytes,
                                             std::size_t largest = kLargestAedat4Packet);

/// Fills the bytes from a position in the file and returns how many there were.
using ReadAt = std::function<std::size_t(std::uint64_t position, std::span<std::byte> into)>;

/// Where in the file the first data at or after t begin, by the file's own table. Empty when it has
/// none, or one that is damaged, tells no times or does not fit what lies there.
std::optional<std::uint64_t> find_in_aedat4_table(const Aedat4Header& header, const ReadAt& read_at,
                                                  SensorTime t);

/// The bytes of a table as they go into a file.
std::vector<std::byte> aedat4_table_bytes(const Aedat4Table& table, Aedat4Compression compression);

/// Packets seen on the way, to be compared with a table without keeping them.
class Aedat4PacketTrace {
public:
    void add(std::int32_t stream, std::int32_t bytes) {
        // FNV-1a over the two numbers.
        for (const std::uint32_t n : {std::uint32_t(stream), std::uint32_t(bytes)})
            hash_ = (hash_ ^ n) * 0x100000001b3;
    }
    friend bool operator==(const Aedat4PacketTrace&, const Aedat4PacketTrace&) = default;

private:
    std::uint64_t hash_ = 0xcbf29ce484222325;
};

}  // namespace eventide
