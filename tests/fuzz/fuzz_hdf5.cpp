// Any bytes as a recording in HDF5: HDF5 itself is trusted, the layout in it is not.
#include "tests/fuzz/fuzz_recording_as.h"

/// HDF5 keeps some hundred bytes of a file that it cannot open.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libhdf5";
}

/// It asks for as much memory as damaged bytes say, and copes with being refused.
extern "C" const char* __asan_default_options() {
    return "allocator_may_return_null=1";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    eventide::fuzz_recording_as("hdf5", data, size);
    return 0;
}
