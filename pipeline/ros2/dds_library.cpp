// Cyclone DDS, loaded when it is first used.
#include "pipeline/ros2/dds_library.h"

#include "src/io/late_library.h"

namespace eventide {

namespace {

DdsLibrary load() {
    const LateLibrary library{EVENTIDE_DDSC, "ROS 2 needs Cyclone DDS", "libddsc0debian"};
    DdsLibrary functions;
#define EVENTIDE_DDS_FIND(name) library.find(functions.name, #name);
    EVENTIDE_DDS_FUNCTIONS(EVENTIDE_DDS_FIND)
#undef EVENTIDE_DDS_FIND
    return functions;
}

}  // namespace

const DdsLibrary& dds() {
    static const DdsLibrary library = load();
    return library;
}

}  // namespace eventide
