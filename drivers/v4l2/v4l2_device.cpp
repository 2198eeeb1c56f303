#include "drivers/v4l2/v4l2_device.h"

#include "drivers/v4l2/v4l2_controls.h"
#include "src/core/error.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace eventide {
namespace {

bool is_multi_planar(std::uint32_t type) {
    return type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

/// Calls use(what the format says of pixels), which lies elsewhere where there are planes.
template <typename Use>
void with_pixels(v4l2_format& format, Use use) {
    if (is_multi_planar(format.type))
        use(format.fmt.pix_mp);
    else
        use(format.fmt.pix);
}

/// What ioctls take that name a mapped buffer; `plane` has to live as long.
v4l2_buffer mapped_buffer(std::uint32_t type, v4l2_plane& plane, std::uint32_t index = 0) {
    v4l2_buffer buffer{};
    buffer.index = index;
    buffer.type = type;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (is_multi_planar(type)) {
        buffer.m.planes = &plane;
        buffer.length = 1;
    }
    return buffer;
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

std::vector<std::uint32_t> offered_formats(int fd, std::uint32_t type) {
    std::vector<std::uint32_t> all;
    v4l2_fmtdesc offered{};
    for (offered.type = type; v4l2_ioctl(fd, VIDIOC_ENUM_FMT, &offered) == 0; ++offered.index)
        all.push_back(offered.pixelformat);
    return all;
}

V4l2Device::V4l2Device(const std::filesystem::path& node, int buffers, const FormatChoice& choose)
    : node_(node), fd_(::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
    if (fd_.get() < 0) fail("cannot be opened", errno);
    query();
    choose_format(choose);
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
                                       explain_v4l2_error(error, kIfNoSensor, kIfSensorBusy) +
                                       way_out);
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
}

/// The size is the driver's to say.
void V4l2Device::choose_format(const FormatChoice& choose) {
    v4l2_format format{};
    format.type = type_;
    if (const int error = v4l2_ioctl(fd_.get(), VIDIOC_G_FMT, &format); error != 0)
        fail("does not say its format", error);
    take_format(format);
    const auto other = choose(fourcc_, offered_formats(fd_.get(), type_));
    if (!other) return;
    format = {};
    format.type = type_;
    with_pixels(format, [&](auto& pixels) {
        pixels.pixelformat = *other;
        pixels.width = std::uint32_t(width_);
        pixels.height = std::uint32_t(height_);
    });
    if (const int error = v4l2_ioctl(fd_.get(), VIDIOC_S_FMT, &format); error != 0)
        fail("cannot be set from format '" + fourcc_text(fourcc_) + "' to '" + fourcc_text(*other) +
                 "'",
             error);
    take_format(format);
}

void V4l2Device::take_format(v4l2_format& format) {
    with_pixels(format, [&](const auto& pixels) {
        fourcc_ = pixels.pixelformat;
        width_ = int(pixels.width);
        height_ = int(pixels.height);
    });
}

void V4l2Device::map_buffers(int wanted) {
    v4l2_requestbuffers request{};
    request.count = std::uint32_t(wanted);
    request.type = type_;
    request.memory = V4L2_MEMORY_MMAP;
    if (const int error = v4l2_ioctl(fd_.get(), VIDIOC_REQBUFS, &request); error != 0)
        fail("gives no buffers", error);
    for (std::uint32_t i = 0; i < request.count; ++i) {
        v4l2_plane plane{};
        v4l2_buffer buffer = mapped_buffer(type_, plane, i);
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
    v4l2_plane plane{};
    v4l2_buffer buffer = mapped_buffer(type_, plane, index);
    plane.length = std::uint32_t(buffers_[index].bytes().size());
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
    v4l2_plane plane{};
    v4l2_buffer buffer = mapped_buffer(type_, plane);
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

}  // namespace eventide
