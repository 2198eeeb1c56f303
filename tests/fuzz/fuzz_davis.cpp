// Hostile bytes into DavisParser.
#include "src/codec/davis.h"
#include "tests/fuzz/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    fuzz_parser({reinterpret_cast<const std::byte*>(data), size}, 346, 260,
                [] { return std::make_unique<DavisParser>(DavisSensor{}); });
    return 0;
}
