// Any bytes as a ROS 2 bag in an SQLite file: SQLite itself is trusted, what lies in it is not.
#include "tests/fuzz/fuzz_recording_as.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    eventide::fuzz_recording_as("db3", data, size);
    return 0;
}
