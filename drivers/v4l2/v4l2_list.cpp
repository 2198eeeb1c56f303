// Which video nodes carry events, and how "v4l2:/dev/videoN" becomes a camera.
#include "drivers/v4l2/v4l2_camera.h"
#include "src/core/error.h"

#include <fcntl.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace eventide {
namespace {

/// The node's card and the format in which it gives events, or would, without disturbing whoever
/// streams from it; empty where it is no capture node or gives none.
std::optional<std::pair<std::uint32_t, std::string>> ask(const std::filesystem::path& node) {
    const FileDescriptor fd{::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)};
    v4l2_capability capability{};
    if (fd.get() < 0 || v4l2_ioctl(fd.get(), VIDIOC_QUERYCAP, &capability) != 0)
        return std::nullopt;
    for (const std::uint32_t type :
         {V4L2_BUF_TYPE_VIDEO_CAPTURE, V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE}) {
        v4l2_format format{};
        format.type = type;
        if (v4l2_ioctl(fd.get(), VIDIOC_G_FMT, &format) != 0) continue;
        const std::uint32_t fourcc = type == V4L2_BUF_TYPE_VIDEO_CAPTURE
                                         ? format.fmt.pix.pixelformat
                                         : format.fmt.pix_mp.pixelformat;
        std::vector<std::uint32_t> formats{fourcc};
        std::ranges::copy(offered_formats(fd.get(), type), std::back_inserter(formats));
        const auto found =
            std::ranges::find_if(formats, [](auto f) { return encoding_of(f).has_value(); });
        if (found == formats.end()) return std::nullopt;
        return std::pair{*found, std::string{reinterpret_cast<const char*>(capability.card)}};
    }
    return std::nullopt;
}

}  // namespace

std::vector<CameraDescription> list_v4l2_cameras() {
    std::vector<std::filesystem::path> nodes;
    std::error_code none;  // a machine without /dev/video* has no such cameras
    for (const auto& entry : std::filesystem::directory_iterator{"/dev", none})
        if (entry.path().filename().string().starts_with("video")) nodes.push_back(entry.path());
    std::sort(nodes.begin(), nodes.end());
    std::vector<CameraDescription> cameras;
    for (const auto& node : nodes) {
        const auto answer = ask(node);
        if (!answer) continue;
        CameraDescription camera;
        camera.source = "v4l2:" + node.string();
        camera.name = answer->second + " (" + fourcc_text(answer->first) + ")";
        cameras.push_back(std::move(camera));
    }
    return cameras;
}

std::unique_ptr<Camera> open_v4l2(std::string_view node, const CameraOptions& options) {
    if (node.empty()) throw Error(ErrorKind::usage, "source 'v4l2:': expected v4l2:/dev/videoN");
    return std::make_unique<V4l2Camera>(
        std::filesystem::path{node},
        options.settings.empty() ? V4l2Settings{} : load_v4l2_settings(options.settings),
        options.reconnect, options.warn);
}

}  // namespace eventide
