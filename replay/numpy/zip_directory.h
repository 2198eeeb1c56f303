// What is in a zip archive, and where.
#pragma once

#include "replay/stream/byte_file.h"

#include <cstdint>
#include <string>
#include <vector>

namespace eventide {

struct ZipEntry {
    std::string name;
    std::uint16_t method = 0;  ///< 0 stored, 8 deflated
    std::uint64_t begin = 0;   ///< of the data, bytes from the file's beginning
    std::uint64_t packed_size = 0, size = 0;
};

/// In the order of the archive, also of large ones (zip64). Throws Error (input) naming the file
/// where its directory is missing, damaged, or leads out of the file.
std::vector<ZipEntry> read_zip_directory(const ByteFile& file);

}  // namespace eventide
