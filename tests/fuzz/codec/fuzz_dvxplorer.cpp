// Hostile bytes into DvxplorerParser.
#include "src/codec/inivation/dvxplorer.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    fuzz_parser({reinterpret_cast<const std::byte*>(data), size}, 640, 480,
                [] { return std::make_unique<DvxplorerParser>(DvxplorerSensor{}); });
    return 0;
}
