// The kinds of video file.
#include "pipeline/sinks/video/video_kind.h"

#include "src/core/error.h"
#include "src/core/lower_case.h"

#include <algorithm>
#include <string>

namespace eventide {

namespace {

constexpr VideoKind kKinds[]{
    {".mp4", "libx264", "yuv420p", false, 1'000'000, 1e6, true, 1, INT32_MAX - 1},
    {".mkv", "libx264", "yuv420p", false, 1'000'000, 1e6, true, 1, INT64_MAX},
    // A Motion JPEG file has one rate and no times: libav fills up what is left out, so many frames
    // at most.
    {".avi", "mjpeg", "yuvj420p", true, 0, 1e6, true, 1, 60'000},
    // 256 colours: all the greys there are. Players show what is to stand shorter than 20 ms for
    // 100 ms.
    {".gif", "gif", "gray", true, 100, 50, false, 2, UINT16_MAX}};

const VideoKind* find(const std::filesystem::path& path) {
    const auto found =
        std::ranges::find(kKinds, lower_case(path.extension().string()), &VideoKind::extension);
    return found == std::end(kKinds) ? nullptr : found;
}

}  // namespace

const VideoKind& video_kind_of(const std::filesystem::path& path) {
    if (const VideoKind* kind = find(path)) return *kind;
    throw Error(ErrorKind::usage,
                path.string() + ": expected a video file ending in .mp4, .mkv, .avi or .gif");
}

bool names_video(const std::filesystem::path& path) {
    return find(path) != nullptr;
}

std::filesystem::path sigma_path(std::filesystem::path path) {
    const std::string extension = path.extension().string();
    return path.replace_extension(".sigma" + extension);
}

}  // namespace eventide
