// DAT from arbitrary bytes, as each kind of record.
#include "src/codec/prophesee/dat.h"
#include "tests/fuzz/codec/fuzz_parser.h"

#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    const auto header = find_dat_header(bytes);
    require(!header || header->stream.data_offset <= size);
    using Record = DatHeader::Record;
    for (const Record record : {Record::events_v1, Record::events_v2, Record::triggers})
        fuzz_parser(bytes, 304, 240, [&] { return std::make_unique<DatParser>(record, 304, 240); });
    return 0;
}
