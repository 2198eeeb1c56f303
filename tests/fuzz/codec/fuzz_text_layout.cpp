// The layout of text recordings: any options, any first rows. The first byte chooses the unit, the
// first line names the columns.
#include "src/codec/text/text.h"
#include "src/core/error.h"
#include "tests/fuzz/codec/fuzz_parser.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    if (size == 0) return 0;
    TextOptions options;
    options.unit = TextTimeUnit(data[0] % 5);
    std::string_view rest = text_of_input(data + 1, size - 1);
    options.columns = take_until(rest, '\n');
    const auto rows = std::as_bytes(std::span{rest});
    looks_like_text(rows);
    try {
        const TextHeader header = read_text_header(rows, options);
        require(header.stream.data_offset <= rows.size());
        require(header.layout.unit != TextTimeUnit::automatic);
        require(header.layout.n_columns <= TextLayout::kMaxColumns);
    } catch (const Error&) {
    }
    return 0;
}
