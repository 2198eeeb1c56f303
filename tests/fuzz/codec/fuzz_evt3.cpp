// EVT3 from arbitrary bytes: header lines, then words.
#include "src/codec/prophesee/evt3.h"
#include "src/codec/prophesee/evt_header.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    const auto header = find_evt_header(bytes);
    const std::size_t begin = header ? std::size_t(header->stream.data_offset) : 0;
    require(begin <= size);
    fuzz_parser(bytes.subspan(begin), 1280, 720, [&] {
        return std::make_unique<Evt3Parser>(1280, 720, header ? header->time_base_us : 0);
    });
    return 0;
}
