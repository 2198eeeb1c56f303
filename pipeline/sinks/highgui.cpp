// OpenCV's highgui by dlopen().
#include "pipeline/sinks/highgui.h"

#include "src/io/late_library.h"

namespace eventide {

namespace {

HighGui load() {
    const LateLibrary library{EVENTIDE_OPENCV_HIGHGUI, "--out window", "libopencv-highgui406"};
    HighGui gui{};
#define NAMED "ERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE"
    library.find(gui.named_window, "_ZN2cv11namedWindow" NAMED "i");
    library.find(gui.resize_window, "_ZN2cv12resizeWindow" NAMED "ii");
    library.find(gui.show, "_ZN2cv6imshow" NAMED "RKNS_11_InputArrayE");
    library.find(gui.wait_key, "_ZN2cv7waitKeyEi");
    library.find(gui.window_property, "_ZN2cv17getWindowProperty" NAMED "i");
    library.find(gui.destroy_window, "_ZN2cv13destroyWindow" NAMED);
#undef NAMED
    return gui;
}

}  // namespace

const HighGui& highgui() {
    static const HighGui loaded = load();
    return loaded;
}

}  // namespace eventide
