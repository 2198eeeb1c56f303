// What is in a zip archive, and where.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// An archive's bytes, of a file or in memory.
struct ZipArchive {
    std::string name;  ///< for messages
    std::uint64_t size = 0;
    /// Fills `into` from an offset on; returns how much of it.
    std::function<std::size_t(std::uint64_t offset, std::span<std::byte> into)> read_at;
};

struct ZipEntry {
    std::string name;
    std::uint16_t method = 0;  ///< 0 stored, 8 deflated
    std::uint32_t crc = 0;     ///< of what was packed (zlib's crc32)
    std::uint64_t begin = 0;   ///< of the data, bytes from the file's beginning
    std::uint64_t packed_size = 0, size = 0;
};

/// In the order of the archive, also of large ones (zip64). Throws Error (input) naming the archive
/// where its directory is missing, damaged, or leads out of it.
std::vector<ZipEntry> read_zip_directory(const ZipArchive& archive);

}  // namespace eventide
