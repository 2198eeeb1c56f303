// The first bytes of any file: every format's header, whether or not it would be chosen.
#include "replay/formats.h"
#include "replay/unsupported_formats.h"
#include "src/codec/aedat/aedat_header.h"
#include "src/codec/prophesee/evt_header.h"
#include "src/core/error.h"
#include "tests/fuzz/codec/fuzz_parser.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span head(reinterpret_cast<const std::byte*>(data), size);
    describe_foreign(head);
    detect_format(head);
    find_value(read_aedat_lines(head), "AEChip");
    require(read_percent_lines(head).bytes <= size);
    for (const Format& format : all_formats()) try {
            format.matches(head);
            if (format.open != nullptr) require(format.open(head, {}).header.data_offset <= size);
        } catch (const Error&) {
        }
    return 0;
}
