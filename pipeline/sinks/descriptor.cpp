// Writing to file descriptors.
#include "pipeline/sinks/descriptor.h"

#include "pipeline/sinks/new_file.h"
#include "src/core/error.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace eventide {

static_assert(kStandardOutput == STDOUT_FILENO);

namespace {

bool is_named_pipe(const std::string& path) {
    struct stat status {};
    return stat(path.c_str(), &status) == 0 && S_ISFIFO(status.st_mode);
}

/// open() of a pipe without a reader would wait where no signal can end it; so it is asked again
/// every 20 ms.
int open_pipe(const std::string& path, const std::function<bool()>& give_up) {
    for (;;) {
        const int file = ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
        if (file >= 0) {
            // From here on a slow reader makes us wait.
            ::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) & ~O_NONBLOCK);
            return file;
        }
        if (errno != ENXIO)
            throw Error(ErrorKind::failed, path + ": cannot be opened: " + last_system_error());
        if (give_up && give_up()) return -1;
        ::poll(nullptr, 0, 20);
    }
}

}  // namespace

std::string last_system_error() {
    return std::error_code{errno, std::generic_category()}.message();
}

int open_for_writing(const std::string& path, bool overwrite,
                     const std::function<bool()>& give_up) {
    if (is_named_pipe(path)) return open_pipe(path, give_up);
    refuse_existing(path, overwrite);
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0)
        throw Error(ErrorKind::failed, path + ": cannot be opened: " + last_system_error());
    return file;
}

WriteResult write_all(int file, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::write(file, bytes.data(), bytes.size());
        if (n >= 0) {
            bytes = bytes.subspan(std::size_t(n));
        } else if (errno == EPIPE) {
            return WriteResult::reader_gone;
        } else if (errno == EAGAIN) {
            // Standard output may have been made non-blocking by whoever shares it.
            pollfd waiting{file, POLLOUT, 0};
            ::poll(&waiting, 1, -1);
        } else if (errno != EINTR) {
            return WriteResult::failed;
        }
    }
    return WriteResult::written;
}

void close_descriptor(int file) {
    ::close(file);
}

}  // namespace eventide
