// Any bytes as a ROS 2 bag in an MCAP file.
#include "tests/fuzz/fuzz_recording_as.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    eventide::fuzz_recording_as("mcap", data, size);
    return 0;
}
