// Any bytes as a model file: refused with an Error, or a network that runs.
#include "src/core/error.h"
#include "src/model/encode/encoder.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    try {
        const Model model = load_model(file.path());
        EngineOptions options;
        options.engine = Engine::plain;
        Encoder{model, 16, 16, options}.reset();
    } catch (const Error&) {
    }
    return 0;
}
