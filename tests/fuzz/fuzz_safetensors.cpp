// Any bytes as a tensor file: refused with an Error, or read and the same when written and read
// again.
#include "src/core/error.h"
#include "src/nn/safetensors.h"

#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    try {
        const TensorFile file =
            parse_safetensors({reinterpret_cast<const std::byte*>(data), size}, "fuzz");
        if (parse_safetensors(format_safetensors(file), "again") != file) std::abort();
    } catch (const Error&) {
    }
    return 0;
}
