// AEDAT 2.0 from arbitrary bytes, as a DAVIS small enough to complete frames, and as a DVS128.
#include "src/codec/aedat/aedat2.h"
#include "src/core/error.h"
#include "tests/fuzz/codec/fuzz_parser.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    try {
        require(read_aedat2_header(bytes).stream.data_offset <= size);
    } catch (const Error&) {
    }
    fuzz_parser(bytes, 3, 2,
                [] { return std::make_unique<Aedat2Parser>(Aedat2Sensor::davis, 3, 2); });
    fuzz_parser(bytes, 128, 128,
                [] { return std::make_unique<Aedat2Parser>(Aedat2Sensor::dvs128, 128, 128); });
    return 0;
}
