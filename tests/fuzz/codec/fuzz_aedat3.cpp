// AEDAT 3 from arbitrary bytes: header lines, then packets.
#include "src/codec/aedat/aedat3.h"
#include "src/core/error.h"
#include "tests/fuzz/codec/fuzz_parser.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    Aedat3Header header;
    std::size_t begin = 0;
    try {
        header = read_aedat3_header(bytes);
        begin = std::size_t(header.stream.data_offset);
        require(begin <= size);
    } catch (const Error&) {
    }
    fuzz_parser(bytes.subspan(begin), 346, 260,
                [&] { return std::make_unique<Aedat3Parser>(header, 346, 260); });
    return 0;
}
