// Hostile bytes into Dvs128Parser.
#include "src/codec/inivation/dvs128.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    fuzz_parser({reinterpret_cast<const std::byte*>(data), size}, 128, 128,
                [] { return std::make_unique<Dvs128Parser>(); });
    return 0;
}
