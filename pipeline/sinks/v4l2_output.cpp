#include "pipeline/sinks/v4l2_output.h"

#include "pipeline/sinks/video/yuv.h"
#include "src/core/error.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>

namespace eventide {
namespace {

constexpr std::uint8_t kNoColour = 128;

struct Packing {
    V4l2PixelFormat format;
    std::uint32_t fourcc;
    std::size_t bytes_per_two_pixels;
    bool even;  // needs even sides
};
// In the order in which they are offered when the user does not say.
constexpr std::array kPackings{Packing{V4l2PixelFormat::yuyv, V4L2_PIX_FMT_YUYV, 4, true},
                               Packing{V4l2PixelFormat::grey, V4L2_PIX_FMT_GREY, 2, false},
                               Packing{V4l2PixelFormat::yu12, V4L2_PIX_FMT_YUV420, 3, true}};

const Packing& packing_of(V4l2PixelFormat format) {
    return *std::find_if(kPackings.begin(), kPackings.end(),
                         [&](const Packing& p) { return p.format == format; });
}

}  // namespace

V4l2OutputSink::V4l2OutputSink(V4l2OutputSettings settings) : settings_(std::move(settings)) {
    const Uncertainty how = settings_.uncertainty;
    if (how != Uncertainty::none && how != Uncertainty::automatic && how != Uncertainty::side)
        throw Error(ErrorKind::usage, "v4l2:" + settings_.node.string() +
                                          " shows sigma as none or side, not as " +
                                          std::string{name_of(how)});
    file_ = FileDescriptor{::open(settings_.node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)};
    if (file_.get() < 0) fail("cannot be opened", errno);
    v4l2_capability capability{};
    if (const int error = v4l2_ioctl(file_.get(), VIDIOC_QUERYCAP, &capability); error != 0)
        fail("is no video device", error);
    if ((capabilities_of(capability) & V4L2_CAP_VIDEO_OUTPUT) == 0)
        fail("takes no video (a camera, or a loopback in use by another writer)", EINVAL);
}

void V4l2OutputSink::fail(const char* what, int error) const {
    throw Error(ErrorKind::device,
                "v4l2:" + settings_.node.string() + " " + what + ": " +
                    explain_v4l2_error(error, "load it with: modprobe v4l2loopback",
                                       "another program writes to it"));
}

bool V4l2OutputSink::try_format(V4l2PixelFormat format, int width, int height) {
    const Packing& packing = packing_of(format);
    if (packing.even) {
        width &= ~1;
        height &= ~1;
    }
    if (width < 2 || height < 2) return false;
    const std::size_t bytes =
        std::size_t(width) * std::size_t(height) * packing.bytes_per_two_pixels / 2;
    v4l2_format wanted{};
    wanted.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    wanted.fmt.pix.width = std::uint32_t(width);
    wanted.fmt.pix.height = std::uint32_t(height);
    wanted.fmt.pix.pixelformat = packing.fourcc;
    wanted.fmt.pix.field = V4L2_FIELD_NONE;
    wanted.fmt.pix.sizeimage = std::uint32_t(bytes);
    wanted.fmt.pix.colorspace = V4L2_COLORSPACE_SRGB;
    if (const int error = v4l2_ioctl(file_.get(), VIDIOC_S_FMT, &wanted); error != 0) {
        if (error == EBUSY) fail("is held at another size or format by a reader or writer", error);
        return false;
    }
    // Drivers may change what was asked for; only the very same will do.
    if (wanted.fmt.pix.pixelformat != packing.fourcc || int(wanted.fmt.pix.width) != width ||
        int(wanted.fmt.pix.height) != height)
        return false;
    format_ = format;
    luma_ = luma_table(format == V4l2PixelFormat::grey ? YuvCoding::jpeg : YuvCoding::video);
    width_ = width;
    height_ = height;
    bytes_.assign(bytes, kNoColour);
    return true;
}

void V4l2OutputSink::fix_format(int width, int height) {
    for (const Packing& packing : kPackings)
        if ((!settings_.format || *settings_.format == packing.format) &&
            try_format(packing.format, width, height))
            return;
    throw Error(ErrorKind::device,
                "v4l2:" + settings_.node.string() + " does not take " + std::to_string(width) +
                    "x" + std::to_string(height) +
                    (settings_.format ? " in the format asked for" : " as YUYV, GREY or YU12"));
}

/// Chroma stays at kNoColour.
void V4l2OutputSink::pack(const cv::Mat& image) {
    for (int y = 0; y < height_; ++y) {
        const std::uint8_t* from = image.ptr<std::uint8_t>(y);
        const std::size_t at = std::size_t(y) * std::size_t(width_);
        const std::size_t step = format_ == V4l2PixelFormat::yuyv ? 2 : 1;
        for (int x = 0; x < width_; ++x) bytes_[step * (at + std::size_t(x))] = luma_[from[x]];
    }
}

void V4l2OutputSink::write(const Frame& frame) {
    draw(frame, settings_.uncertainty, settings_.sigma_white, image_);
    if (width_ == 0) fix_format(image_.cols, image_.rows);
    if (image_.cols < width_ || image_.rows < height_ || image_.cols > width_ + 1 ||
        image_.rows > height_ + 1)
        throw Error(ErrorKind::failed, "v4l2:" + settings_.node.string() + " was opened at " +
                                           std::to_string(width_) + "x" + std::to_string(height_) +
                                           ", a frame of " + std::to_string(image_.cols) + "x" +
                                           std::to_string(image_.rows) + " does not fit");
    pack(image_);
    ssize_t written = 0;
    do written = ::write(file_.get(), bytes_.data(), bytes_.size());
    while (written < 0 && errno == EINTR);
    if (written < 0 && errno == EAGAIN)
        ++skipped_;
    else if (written < 0)
        fail("takes no more frames", errno);
}

}  // namespace eventide
