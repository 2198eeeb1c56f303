// Hostile bytes into DvxplorerMiniParser.
#include "src/codec/inivation/dvxplorer_mini.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    fuzz_parser({reinterpret_cast<const std::byte*>(data), size}, 640, 480,
                [] { return std::make_unique<DvxplorerMiniParser>(DvxplorerSensor{}); });
    return 0;
}
