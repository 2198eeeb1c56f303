#include "drivers/v4l2/v4l2_device.h"

#include "src/core/error.h"
#include "src/core/lower_case.h"

#include <fcntl.h>
#include <linux/v4l2-subdev.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

namespace eventide {
namespace {

constexpr const char* kIfMissing = "is the driver loaded and the sensor connected?";
constexpr const char* kIfBusy = "in use by another program";

bool is_multi_planar(std::uint32_t type) {
    return type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

}  // namespace

std::string fourcc_text(std::uint32_t fourcc) {
    std::string text;
    for (int shift = 0; shift < 32; shift += 8) {
        const char c = char((fourcc >> shift) & 0x7F);
        text += c >= ' ' ? c : '?';
    }
    return text;
}

V4l2Device::V4l2Device(const std::filesystem::path& node, int buffers)
    : node_(node), fd_(::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
    if (fd_.get() < 0) fail("cannot be opened", errno);
    query();
    map_buffers(buffers);
    for (std::uint32_t i = 0; i < buffers_.size(); ++i)
        if (const int error = queue(i); error != 0) fail("does not take a buffer", error);
    start_streaming();
}

V4l2Device::~V4l2Device() {
    int type = int(type_);
    v4l2_ioctl(fd_.get(), VIDIOC_STREAMOFF, &type);
}

V4l2Device::Buffer::~Buffer() {
    if (!bytes_.empty()) ::munmap(bytes_.data(), bytes_.size());
}

void V4l2Device::fail(const std::string& what, int error, const std::string& way_out) const {
    throw Error(ErrorKind::device, "the camera " + node_.string() + " " + what + ": " +
                                       explain_v4l2_error(error, kIfMissing, kIfBusy) + way_out);
}

/// On boards where sensor and receiver are parts of a media graph, only this request looks whether
/// they fit.
void V4l2Device::start_streaming() {
    int type = int(type_);
    const int error = v4l2_ioctl(fd_.get(), VIDIOC_STREAMON, &type);
    if (error == 0) return;
    const char* way_out =
        error == EPIPE ? " (formats differ between the sensor and this node: set them alike with "
                         "media-ctl)"
        : error == ENOLINK ? " (no sensor is linked to this node: link one with media-ctl)"
                           : "";
    fail("does not start streaming", error, way_out);
}

void V4l2Device::query() {
    v4l2_capability capability{};
    if (const int error = v4l2_ioctl(fd_.get(), VIDIOC_QUERYCAP, &capability); error != 0)
        fail("is not a V4L2 device", error);
    card_ = reinterpret_cast<const char*>(capability.card);
    const std::uint32_t caps = capabilities_of(capability);
    if ((caps & V4L2_CAP_VIDEO_CAPTURE) != 0)
        type_ = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    else if ((caps & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0)
        type_ = V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
    else
        fail("does not capture (it may be an output or metadata node)", EINVAL);
    if ((caps & V4L2_CAP_STREAMING) == 0) fail("cannot stream into mapped memory", ENOTSUP);

    v4l2_format format{};
    format.type = type_;
    if (const int error = v4l2_ioctl(fd_.get(), VIDIOC_G_FMT, &format); error != 0)
        fail("does not say its format", error);
    fourcc_ = is_multi_planar(type_) ? format.fmt.pix_mp.pixelformat : format.fmt.pix.pixelformat;
    width_ = int(is_multi_planar(type_) ? format.fmt.pix_mp.width : format.fmt.pix.width);
    height_ = int(is_multi_planar(type_) ? format.fmt.pix_mp.height : format.fmt.pix.height);
}

void V4l2Device::map_buffers(int wanted) {
    v4l2_requestbuffers request{};
    request.count = std::uint32_t(wanted);
    request.type = type_;
    request.memory = V4L2_MEMORY_MMAP;
    if (const int error = v4l2_ioctl(fd_.get(), VIDIOC_REQBUFS, &request); error != 0)
        fail("gives no buffers", error);
    for (std::uint32_t i = 0; i < request.count; ++i) {
        v4l2_buffer buffer{};
        v4l2_plane plane{};
        buffer.index = i;
        buffer.type = type_;
        buffer.memory = V4L2_MEMORY_MMAP;
        if (is_multi_planar(type_)) {
            buffer.m.planes = &plane;
            buffer.length = 1;
        }
        if (const int error = v4l2_ioctl(fd_.get(), VIDIOC_QUERYBUF, &buffer); error != 0)
            fail("does not describe its buffers", error);
        const std::size_t length = is_multi_planar(type_) ? plane.length : buffer.length;
        const auto offset = off_t(is_multi_planar(type_) ? plane.m.mem_offset : buffer.m.offset);
        void* memory =
            ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_.get(), offset);
        if (memory == MAP_FAILED) fail("does not map its buffers", errno);
        buffers_.emplace_back(memory, length);
    }
    if (buffers_.size() < 2) fail("gives fewer than two buffers", ENOMEM);
}

int V4l2Device::queue(std::uint32_t index) {
    v4l2_buffer buffer{};
    v4l2_plane plane{};
    buffer.index = index;
    buffer.type = type_;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (is_multi_planar(type_)) {
        plane.length = std::uint32_t(buffers_[index].bytes().size());
        buffer.m.planes = &plane;
        buffer.length = 1;
    }
    return v4l2_ioctl(fd_.get(), VIDIOC_QBUF, &buffer);
}

V4l2Device::Status V4l2Device::read(Filled& into, std::chrono::milliseconds timeout) {
    if (held_)
        if (const int error = queue(*std::exchange(held_, std::nullopt)); error != 0) {
            into.why = std::system_category().message(error);  // EIO, ENODEV, as of dequeue()
            return Status::lost;
        }
    pollfd poll_fd{fd_.get(), POLLIN, 0};
    if (::poll(&poll_fd, 1, int(timeout.count())) == 0) return Status::timeout;
    return dequeue(into);  // which says what poll() would not
}

V4l2Device::Status V4l2Device::dequeue(Filled& into) {
    v4l2_buffer buffer{};
    v4l2_plane plane{};
    buffer.type = type_;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (is_multi_planar(type_)) {
        buffer.m.planes = &plane;
        buffer.length = 1;
    }
    const int error = v4l2_ioctl(fd_.get(), VIDIOC_DQBUF, &buffer);
    if (error == EAGAIN) return Status::timeout;
    if (error != 0) {  // EIO, ENODEV: the sensor stopped or went away
        into.why = std::system_category().message(error);
        return Status::lost;
    }
    if (buffer.index >= buffers_.size()) {
        into.why = "it gave a buffer there is not";
        return Status::lost;
    }
    held_ = buffer.index;
    const std::span<const std::byte> filled = buffers_[buffer.index].bytes();
    const std::size_t offset = is_multi_planar(type_) ? plane.data_offset : 0;
    const std::size_t used = is_multi_planar(type_) ? plane.bytesused : buffer.bytesused;
    const std::size_t end = std::min(used, filled.size()), begin = std::min(offset, end);
    into.bytes = filled.subspan(begin, end - begin);
    into.sequence = buffer.sequence;
    into.damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
    return Status::data;
}

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
                                           explain_v4l2_error(errno, kIfMissing, kIfBusy));
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
