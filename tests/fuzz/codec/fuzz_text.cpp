// Text recordings from arbitrary bytes: layout, then rows.
#include "src/codec/text/text.h"
#include "src/core/error.h"
#include "tests/fuzz/codec/fuzz_parser.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
    TextLayout layout;
    std::size_t begin = 0;
    looks_like_text(bytes);
    try {
        const TextHeader header = read_text_header(bytes, {});
        layout = header.layout;
        begin = std::size_t(header.stream.data_offset);
        require(begin <= size);
    } catch (const Error&) {
    }
    fuzz_parser(bytes.subspan(begin), 240, 180,
                [&] { return std::make_unique<TextParser>(layout, 240, 180); });
    return 0;
}
