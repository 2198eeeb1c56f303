#include "drivers/v4l2/v4l2_controls.h"

#include "src/core/error.h"
#include "src/core/lower_case.h"

#include <fcntl.h>
#include <linux/v4l2-subdev.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <string_view>
#include <system_error>
#include <vector>

namespace eventide {
namespace {

/// As v4l2-ctl lists a control: what is neither letter nor digit becomes one underscore.
std::string listed_name(std::string_view name) {
    std::string listed;
    bool between = false;
    for (const char c : name) {
        const bool is_word =
            (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (is_word && between && !listed.empty()) listed += '_';
        if (is_word) listed += c;
        between = !is_word;
    }
    return lower_case(listed);
}

struct KnownControl {
    std::uint32_t id = 0;
    std::string called;  // "control 'bias_fo' of /dev/video0", behind where it was said
    std::int64_t value = 0;
};

/// Whether it is to be written. Throws Error (usage) where it cannot have the value.
bool may_set(int fd, const v4l2_query_ext_ctrl& query, const KnownControl& wanted) {
    v4l2_control now{query.id, 0};
    if ((query.flags & (V4L2_CTRL_FLAG_READ_ONLY | V4L2_CTRL_FLAG_DISABLED)) != 0) {
        const bool is_known = v4l2_ioctl(fd, VIDIOC_G_CTRL, &now) == 0;
        if (is_known && now.value == wanted.value) return false;
        throw Error(ErrorKind::usage,
                    wanted.called + " cannot be written: expected " +
                        (is_known ? "its value, " + std::to_string(now.value) : "it left out") +
                        ", found " + std::to_string(wanted.value));
    }
    if (wanted.value < query.minimum || wanted.value > query.maximum)
        throw Error(ErrorKind::usage,
                    wanted.called + ": expected " + std::to_string(query.minimum) + " to " +
                        std::to_string(query.maximum) + ", found " + std::to_string(wanted.value));
    return true;
}

void set_control(int fd, const KnownControl& wanted) {
    v4l2_control control{wanted.id, std::int32_t(wanted.value)};
    if (const int error = v4l2_ioctl(fd, VIDIOC_S_CTRL, &control); error != 0)
        throw Error(ErrorKind::device,
                    wanted.called + ": " + std::system_category().message(error));
    if (v4l2_ioctl(fd, VIDIOC_G_CTRL, &control) == 0 && control.value != wanted.value)
        throw Error(ErrorKind::device, wanted.called + ": set to " + std::to_string(wanted.value) +
                                           ", reads back as " + std::to_string(control.value));
}

}  // namespace

void set_v4l2_controls(int fd, const std::string& device,
                       const std::map<std::string, std::int64_t>& wanted,
                       const std::map<std::string, std::string>& places) {
    const auto place_of = [&](const std::string& name) {
        const auto found = places.find(name);
        return (found == places.end() ? "camera settings" : found->second) + ": ";
    };
    auto missing = wanted;
    std::vector<KnownControl> known;
    v4l2_query_ext_ctrl query{};
    constexpr std::uint32_t kNext = V4L2_CTRL_FLAG_NEXT_CTRL;
    for (query.id = kNext; v4l2_ioctl(fd, VIDIOC_QUERY_EXT_CTRL, &query) == 0; query.id |= kNext) {
        auto own = missing.extract(query.name);
        if (own.empty()) own = missing.extract(listed_name(query.name));
        if (own.empty()) continue;
        KnownControl control{query.id,
                             place_of(own.key()) + "control '" + own.key() + "' of " + device,
                             own.mapped()};
        if (may_set(fd, query, control)) known.push_back(std::move(control));
    }
    if (!missing.empty())
        throw Error(ErrorKind::usage, place_of(missing.begin()->first) + device +
                                          " has no control '" + missing.begin()->first + "'");
    for (const KnownControl& control : known) set_control(fd, control);
}

FileDescriptor open_for_controls(const std::filesystem::path& node) {
    FileDescriptor fd{::open(node.c_str(), O_RDWR | O_CLOEXEC)};
    if (fd.get() < 0)
        throw Error(ErrorKind::device, "the camera " + node.string() + " cannot be opened: " +
                                           explain_v4l2_error(errno, kIfNoSensor, kIfSensorBusy));
    return fd;
}

std::optional<std::pair<int, int>> subdevice_size(const std::filesystem::path& subdevice) {
    const FileDescriptor fd = open_for_controls(subdevice);
    v4l2_subdev_selection selection{};
    selection.which = V4L2_SUBDEV_FORMAT_ACTIVE;
    selection.target = V4L2_SEL_TGT_CROP_BOUNDS;
    if (v4l2_ioctl(fd.get(), VIDIOC_SUBDEV_G_SELECTION, &selection) != 0) return std::nullopt;
    return std::pair{int(selection.r.width), int(selection.r.height)};
}

}  // namespace eventide
