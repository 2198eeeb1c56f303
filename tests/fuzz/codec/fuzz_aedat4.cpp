// AEDAT4 from arbitrary bytes: as a whole file, and as packets and a table without a header.
#include "src/codec/aedat4/aedat4.h"
#include "src/core/error.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

/// Unpacked: a few bytes can stand for 256 MiB of zeros, which take a second each time.
constexpr std::size_t kLargestPacket = 16384;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    Aedat4Header header;
    std::size_t begin = 0;
    try {
        header = read_aedat4_header(bytes);
        begin = std::size_t(header.stream.data_offset);
        require(begin <= size);
    } catch (const Error&) {
    }
    read_aedat4_table(bytes, kLargestPacket);
    fuzz_parser(bytes.subspan(begin), 346, 260,
                [&] { return std::make_unique<Aedat4Parser>(header, 346, 260, kLargestPacket); });
    return 0;
}
