// AEDAT4 packets of a build without LZ4 and ZSTD: bare ones alone.
#include "src/codec/aedat4/aedat4_compression.h"
#include "src/core/error.h"

namespace eventide {

namespace {

constexpr const char* kHow =
    "expected bare ones, as this eventide was built without compression; install liblz4-dev, "
    "libzstd-dev and libbz2-dev and build it again with -DEVENTIDE_COMPRESSION=ON";

}  // namespace

struct Aedat4Unpacker::Contexts {};

Aedat4Unpacker::Aedat4Unpacker(std::size_t largest) : largest_(largest) {}

Aedat4Unpacker::~Aedat4Unpacker() = default;

Aedat4Compression usual_aedat4_compression() {
    return Aedat4Compression::none;
}

std::optional<std::span<const std::byte>> Aedat4Unpacker::unpack(
    std::span<const std::byte> packed) {
    if (is_lz4_frame(packed) || is_zstd_frame(packed))
        throw Error(ErrorKind::input, std::string{"packets compressed by LZ4 or ZSTD: "} + kHow);
    return packed;
}

void pack_aedat4(std::span<const std::byte> bytes, Aedat4Compression compression,
                 std::vector<std::byte>& out) {
    if (compression != Aedat4Compression::none)
        throw Error(ErrorKind::usage, std::string{"compressed packets: "} + kHow);
    out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace eventide
