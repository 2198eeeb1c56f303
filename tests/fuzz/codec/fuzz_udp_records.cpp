// Datagrams of arbitrary bytes, as each kind of records.
#include "src/codec/udp_records.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    for (const UdpRecords kind : {UdpRecords::t64, UdpRecords::t32, UdpRecords::spif}) {
        const std::size_t whole = whole_udp_records(kind, bytes);
        require(whole <= size);
        UdpRecordsParser together(kind, 64, 48), apart(kind, 64, 48);
        Batch batch, split;
        const Damage damage = parse_for_fuzzer(together, bytes.first(whole), 0, batch);
        require(damage[DamageReason::truncated] == 0);
        require(parse_for_fuzzer(apart, bytes.first(whole), 13, split) == damage);
        require(batch.events == split.events && batch.triggers == split.triggers);
        for (const Event& event : batch.events) require(event.x < 64 && event.y < 48);
        require_order(batch);
    }
    return 0;
}
