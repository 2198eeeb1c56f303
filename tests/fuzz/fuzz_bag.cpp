// Any bytes as a ROS bag.
#include "src/core/error.h"
#include "src/io/bag_file.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace eventide;
    static MemoryFile file;
    file.hold(data, size);
    try {
        BagFile bag{file.path()};
        Batch batch;
        while (bag.read(batch)) batch.clear();
        bag.types();
    } catch (const Error&) {
    }
    return 0;
}
