// A V4L2 node, to read from or to write to: what the event sensors' driver and the loopback sink
// share.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

struct v4l2_capability;

namespace eventide {

/// A file descriptor that closes itself.
class FileDescriptor {
public:
    explicit FileDescriptor(int fd = -1) : fd_(fd) {}
    FileDescriptor(FileDescriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    FileDescriptor& operator=(FileDescriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }
    ~FileDescriptor();
    int get() const { return fd_; }

private:
    int fd_;
};

/// ioctl() that goes on after a signal. Returns 0 or errno.
int v4l2_ioctl(int fd, unsigned long request, void* argument);

/// What this node can do, where the driver tells it apart from the whole device.
std::uint32_t capabilities_of(const v4l2_capability& capability);

/// The system's words for an errno, and in brackets what to do; what to do when there is no such
/// node or when it is busy depends on what it is for.
std::string explain_v4l2_error(int error, const std::string& if_missing,
                               const std::string& if_busy);

}  // namespace eventide
