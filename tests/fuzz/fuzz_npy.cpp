// Any bytes as a NumPy array that is read in parts.
#include "replay/numpy/numpy_file.h"
#include "src/core/error.h"
#include "tests/fuzz/fuzz_file.h"

#include <algorithm>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    try {
        NumpyFile array{file.path()};
        const std::uint64_t rows = std::min<std::uint64_t>(array.rows(), 3);
        if (array.read(0, rows).size() != rows * array.row_length()) std::abort();
        array.read(array.rows() / 2, 1);
        array.read(array.rows(), 1);
    } catch (const Error&) {
    }
    return 0;
}
