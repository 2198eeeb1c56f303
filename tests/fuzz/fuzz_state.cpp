// Any bytes as a hidden state: refused with an Error, or what comes back is the same.
#include "src/core/error.h"
#include "src/model/encode/encoder.h"
#include "src/nn/safetensors.h"
#include "tests/fuzz/tiny_network.h"
#include "tests/support/random_model.h"

#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static Encoder encoder{test::random_model(tiny_network(), 1), 8, 8};
    try {
        const TensorFile state =
            parse_safetensors({reinterpret_cast<const std::byte*>(data), size}, "fuzz");
        encoder.restore(state, "fuzz");
        if (encoder.state().tensors != state.tensors) std::abort();
    } catch (const Error&) {
    }
    return 0;
}
