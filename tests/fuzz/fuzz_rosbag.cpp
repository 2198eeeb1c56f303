// Any bytes as a ROS 1 bag.
#include "tests/fuzz/fuzz_recording_as.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    eventide::fuzz_recording_as("rosbag", data, size);
    return 0;
}
