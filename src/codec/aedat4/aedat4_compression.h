// The compression of AEDAT4 packets: each one LZ4 or ZSTD frame, or bare.
#pragma once

#include "src/core/byte_order.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace eventide {

/// Numbered as in the file's header.
enum class Aedat4Compression : std::int32_t { none, lz4, lz4_high, zstd, zstd_high };

/// What is written where nobody says: LZ4; none in a build without EVENTIDE_COMPRESSION.
Aedat4Compression usual_aedat4_compression();

/// The largest packet read, packed or not: real ones hold 10 ms or one image. What comes is
/// unpacked into memory that grows with the data themselves, never with a number in the file.
constexpr std::size_t kLargestAedat4Packet = std::size_t(256) << 20;  // bytes

inline bool begins_with_magic(std::span<const std::byte> bytes, std::uint32_t magic) {
    return bytes.size() >= 4 && load_little<std::uint32_t>(bytes.data()) == magic;
}
inline bool is_lz4_frame(std::span<const std::byte> bytes) {
    return begins_with_magic(bytes, 0x184D2204);
}
inline bool is_zstd_frame(std::span<const std::byte> bytes) {
    return begins_with_magic(bytes, 0xFD2FB528);
}

/// Unpacks one packet after the other; keeps its memory.
class Aedat4Unpacker {
public:
    /// A packet of more than `largest` bytes, unpacked, is too large.
    explicit Aedat4Unpacker(std::size_t largest = kLargestAedat4Packet);
    ~Aedat4Unpacker();

    /// The content of an LZ4 or ZSTD frame, or the bytes themselves when they are neither. Borrowed
    /// until the next call. Empty when the frame is damaged, incomplete, or too large. Throws Error
    /// (input) for such a frame in a build without EVENTIDE_COMPRESSION.
    std::optional<std::span<const std::byte>> unpack(std::span<const std::byte> packed);
    std::size_t largest() const { return largest_; }

private:
    struct Contexts;
    std::optional<std::size_t> unpack_lz4(std::span<const std::byte> packed, bool& too_small);
    std::optional<std::size_t> unpack_zstd(std::span<const std::byte> packed, bool& too_small);

    std::size_t largest_;
    std::unique_ptr<Contexts> contexts_;
    std::vector<std::byte> unpacked_;
};

/// Appends the packed bytes. Throws Error: failed when there is no memory for it, usage in a build
/// without EVENTIDE_COMPRESSION for all but none.
void pack_aedat4(std::span<const std::byte> bytes, Aedat4Compression compression,
                 std::vector<std::byte>& out);

}  // namespace eventide
