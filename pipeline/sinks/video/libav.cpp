// FFmpeg's libraries by dlopen().
#include "pipeline/sinks/video/libav.h"

#include "src/io/late_library.h"

namespace eventide {

namespace {

Libav load() {
    constexpr const char* kNeededFor = "video files need FFmpeg's libraries";
    const LateLibrary util{EVENTIDE_AVUTIL, kNeededFor, "libavutil57"},
        codec{EVENTIDE_AVCODEC, kNeededFor, "libavcodec59"},
        format{EVENTIDE_AVFORMAT, kNeededFor, "libavformat59"};
    Libav av;
#define EVENTIDE_FIND(name) codec.find(av.name, #name);
    EVENTIDE_AVCODEC_FUNCTIONS(EVENTIDE_FIND)
#undef EVENTIDE_FIND
#define EVENTIDE_FIND(name) format.find(av.name, #name);
    EVENTIDE_AVFORMAT_FUNCTIONS(EVENTIDE_FIND)
#undef EVENTIDE_FIND
#define EVENTIDE_FIND(name) util.find(av.name, #name);
    EVENTIDE_AVUTIL_FUNCTIONS(EVENTIDE_FIND)
#undef EVENTIDE_FIND
    return av;
}

}  // namespace

const Libav& libav() {
    static const Libav loaded = load();
    return loaded;
}

}  // namespace eventide
