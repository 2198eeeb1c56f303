// Any bytes as a NumPy archive of which the arrays "a" and "b" are asked for.
#include "src/core/error.h"
#include "src/io/npz.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    for (const char* name : {"a", "b"}) try {
            const NpzArray array = NpzFile{file.path()}.array(name);
            std::size_t count = 1;
            for (const std::int64_t n : array.shape) count *= std::size_t(n);
            if (count != array.values.size()) std::abort();
        } catch (const Error&) {
        }
    return 0;
}
