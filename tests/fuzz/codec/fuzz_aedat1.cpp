// AEDAT 1.0 from arbitrary bytes.
#include "src/codec/aedat/aedat1.h"
#include "tests/fuzz/codec/fuzz_parser.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    looks_like_aedat1(bytes);
    const StreamHeader header = read_aedat1_header(bytes);
    require(header.data_offset <= size);
    fuzz_parser(bytes.subspan(std::size_t(header.data_offset)), 128, 128,
                [] { return std::make_unique<Aedat1Parser>(); });
    return 0;
}
