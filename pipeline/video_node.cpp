#include "pipeline/video_node.h"

#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace eventide {

FileDescriptor::~FileDescriptor() {
    if (fd_ >= 0) ::close(fd_);
}

int v4l2_ioctl(int fd, unsigned long request, void* argument) {
    int result = 0;
    do result = ::ioctl(fd, request, argument);
    while (result < 0 && errno == EINTR);
    return result < 0 ? errno : 0;
}

std::uint32_t capabilities_of(const v4l2_capability& capability) {
    return (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps
                                                                 : capability.capabilities;
}

std::string explain_v4l2_error(int error, const std::string& if_missing,
                               const std::string& if_busy) {
    std::string words = std::system_category().message(error);
    switch (error) {
        case EACCES:
            return words + " (no permission: join the group 'video')";
        case EBUSY:
            return words + " (" + if_busy + ")";
        case ENOENT:
        case ENODEV:
        case ENXIO:
            return words + " (" + if_missing + ")";
        default:
            return words;
    }
}

}  // namespace eventide
