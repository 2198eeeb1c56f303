// Any bytes as a list of hot pixels: refused with a piece of it, or pixels of the sensor.
#include "pipeline/filters/hot_pixels.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    try {
        if (HotPixelFilter{32, 24, file.path()}.hot_pixels() > 32 * 24) std::abort();
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::usage || std::string_view{error.what()}.size() > 1000)
            std::abort();
    }
    return 0;
}
