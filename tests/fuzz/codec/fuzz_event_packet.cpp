// EventPackets of ROS drivers from arbitrary bytes: the first one chooses the encoding.
#include "src/codec/event_packet.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    if (size == 0) return 0;
    const auto encoding = EventPacketEncoding(data[0] % 4);
    const std::span bytes(reinterpret_cast<const std::byte*>(data) + 1, size - 1);
    fuzz_parser(bytes, 640, 480,
                [&] { return std::make_unique<EventPacketParser>(encoding, 640, 480); });
    return 0;
}
