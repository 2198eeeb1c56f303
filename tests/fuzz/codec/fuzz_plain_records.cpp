// Plain records from arbitrary bytes.
#include "src/codec/plain_records.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    fuzz_parser(bytes, 64, 48, [] { return std::make_unique<PlainRecordsParser>(64, 48); });
    return 0;
}
