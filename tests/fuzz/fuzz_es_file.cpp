// Any bytes as an Event Stream file, header and all.
#include "tests/fuzz/fuzz_recording_as.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    eventide::fuzz_recording_as("es", data, size);
    return 0;
}
