// Any bytes as one of MVSEC's HDF5 files: HDF5 itself is trusted, the layout in it is not.
#include "apps/evaluate/mvsec_file.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

/// HDF5 keeps some hundred bytes of a file that it cannot open.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libhdf5";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    try {
        read_mvsec_file(file.path(), std::nullopt, std::nullopt);
    } catch (const Error&) {
    }
    return 0;
}
