// The packings of a bag's chunks.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace eventide {

/// `size` bytes from a chunk packed by "none", "bz2" or "lz4" (whose frames are LZ4's own); none
/// where it does not unpack to so many, or for another name. Throws Error (input) for bz2 and lz4
/// in a build without EVENTIDE_COMPRESSION.
std::optional<std::vector<std::byte>> unpack_bag_chunk(std::string_view packing,
                                                       std::span<const std::byte> bytes,
                                                       std::size_t size);

}  // namespace eventide
