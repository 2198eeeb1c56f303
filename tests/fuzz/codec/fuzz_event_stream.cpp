// Event Stream from arbitrary bytes, as each kind.
#include "src/codec/event_stream.h"
#include "src/core/error.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    try {
        require(read_event_stream_header(bytes).stream.data_offset <= size);
    } catch (const Error&) {
    }
    using Kind = EventStreamHeader::Kind;
    for (const Kind kind : {Kind::dvs, Kind::atis})
        fuzz_parser(bytes, 304, 240,
                    [&] { return std::make_unique<EventStreamParser>(kind, 304, 240); });
    return 0;
}
