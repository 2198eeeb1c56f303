// Hostile bytes into DavisParser, of a sensor small enough to complete frames.
#include "src/codec/inivation/davis.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    DavisSensor sensor;
    sensor.dvs_columns = sensor.aps_columns = 2;
    sensor.dvs_rows = sensor.aps_rows = 3;
    fuzz_parser({reinterpret_cast<const std::byte*>(data), size}, sensor.width(), sensor.height(),
                [&] { return std::make_unique<DavisParser>(sensor); });
    return 0;
}
