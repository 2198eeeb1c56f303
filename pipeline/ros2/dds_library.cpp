// Cyclone DDS, loaded when it is first used.
#include "pipeline/ros2/dds_library.h"

#include "src/core/error.h"

#include <dds/ddsrt/log.h>

#include <dlfcn.h>

#include <string>

namespace eventide {

namespace {

template <typename Function>
void find(void* library, const char* name, Function& function) {
    function = reinterpret_cast<Function>(dlsym(library, name));
    if (function == nullptr)
        throw Error(ErrorKind::failed, std::string{EVENTIDE_DDSC} +
                                           ": expected Cyclone DDS 0.10, "
                                           "found one without " +
                                           name);
}

DdsLibrary load() {
    void* library = dlopen(EVENTIDE_DDSC, RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr)
        throw Error(ErrorKind::failed, "ROS 2 needs Cyclone DDS: " + std::string{dlerror()} +
                                           "; Debian's package is libddsc0debian");
    DdsLibrary functions;
#define EVENTIDE_DDS_FIND(name) find(library, #name, functions.name);
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
