// Chunks of bags in a build without bzip2 and LZ4: bare ones alone.
#include "src/core/error.h"
#include "src/io/bag_unpack.h"

#include <string>

namespace eventide {

std::optional<std::vector<std::byte>> unpack_bag_chunk(std::string_view packing,
                                                       std::span<const std::byte> bytes,
                                                       std::size_t size) {
    if (packing == "bz2" || packing == "lz4")
        throw Error(ErrorKind::input,
                    "chunks packed by " + std::string{packing} +
                        ": this eventide was built without compression; install libbz2-dev, "
                        "liblz4-dev and libzstd-dev and build it again with "
                        "-DEVENTIDE_COMPRESSION=ON");
    if (packing != "none" || bytes.size() != size) return {};
    return std::vector(bytes.begin(), bytes.end());
}

}  // namespace eventide
