// Any bytes as a recording of any format, from recognising it to the last event.
#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    try {
        to_json(summarize(*open_recording(file.path())));
    } catch (const Error&) {
    }
    return 0;
}
