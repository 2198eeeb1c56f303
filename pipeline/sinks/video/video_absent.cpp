// Videos of a build without libav.
#include "pipeline/sinks/video/video.h"
#include "src/core/error.h"

#include <utility>

namespace eventide {

class VideoFile {};

VideoSink::VideoSink(VideoSettings settings) : settings_{std::move(settings)} {
    throw Error(ErrorKind::usage,
                settings_.path.string() +
                    ": this eventide was built without videos; write frames (--out frames/) or Y4M "
                    "(--out -), or install libavformat-dev and libavcodec-dev and "
                    "build it again with -DEVENTIDE_VIDEO=ON");
}

VideoSink::~VideoSink() = default;

bool VideoSink::is_read() const {
    return false;
}

void VideoSink::write(const Frame&) {}

void VideoSink::close() {}

std::string video_library() {
    return "no FFmpeg";
}

bool encodes_h264() {
    return false;
}

}  // namespace eventide
