// Reading with POSIX calls: a file by position, a pipe with poll() so that stop() is heard.
#include "replay/stream/byte_file.h"

#include "src/core/error.h"
#include "src/io/stream_name.h"
#include "src/io/system_words.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace eventide {

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& doing) {
    // Having no descriptor left says nothing about the recording.
    const bool exhausted = errno == EMFILE || errno == ENFILE;
    throw Error(exhausted ? ErrorKind::failed : ErrorKind::input,
                path + ": cannot " + doing + ": " + system_words(errno));
}

}  // namespace

ByteFile::ByteFile(const std::string& path, std::function<void()> while_waiting)
    : path_(input_name(path)), while_waiting_(std::move(while_waiting)) {
    owned_ = path != "-";
    // Not blocking: a named pipe would hold the call until someone writes to it.
    fd_ = owned_ ? ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK) : STDIN_FILENO;
    if (fd_ < 0) fail(path_, "open");
    struct stat facts {};
    if (::fstat(fd_, &facts) != 0) fail(path_, "examine");
    if (S_ISDIR(facts.st_mode)) {
        ::close(std::exchange(fd_, -1));
        throw Error(
            ErrorKind::input,
            path_ +
                ": expected a recording, found a directory without events.txt; of a ROS 2 bag, "
                "name the .mcap or .db3 file in it");
    }
    // Standard input redirected from a file is a file too, but it may be shared with others who
    // expect its position to move: it is read as a stream.
    seekable_ = owned_ && S_ISREG(facts.st_mode);
    if (!seekable_) return;
    size_ = std::uint64_t(facts.st_size);
    ::posix_fadvise(fd_, 0, 0, POSIX_FADV_SEQUENTIAL);
}

ByteFile::~ByteFile() {
    if (owned_ && fd_ >= 0) ::close(fd_);
}

ByteFile::ByteFile(ByteFile&& other) noexcept
    : path_(std::move(other.path_)),
      while_waiting_(std::move(other.while_waiting_)),
      fd_(std::exchange(other.fd_, -1)),
      owned_(other.owned_),
      seekable_(other.seekable_),
      size_(other.size_),
      position_(other.position_),
      stopped_(other.stopped_.load()) {}

bool ByteFile::wait_for_bytes(const std::function<bool()>& give_up) const {
    while (!stopped_) {
        if (give_up && give_up())
            throw Error(ErrorKind::failed, path_ + ": stopped while waiting for the first bytes");
        if (while_waiting_) while_waiting_();
        pollfd watched{fd_, POLLIN, 0};
        const int ready = ::poll(&watched, 1, 20);  // ms: how late stop() may be heard
        if (ready > 0) return true;
        if (ready < 0 && errno != EINTR) fail(path_, "wait for bytes");
    }
    return false;
}

std::size_t ByteFile::read_some(std::span<std::byte> into, const std::function<bool()>& give_up) {
    if (stopped_) return 0;
    if (seekable_) {
        const std::size_t n = read_at(position_, into);
        position_ += n;
        return n;
    }
    while (wait_for_bytes(give_up)) {
        const ssize_t n = ::read(fd_, into.data(), into.size());
        if (n < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (n < 0) fail(path_, "read");
        position_ += std::uint64_t(n);
        return std::size_t(n);
    }
    return 0;
}

std::size_t ByteFile::read_at(std::uint64_t offset, std::span<std::byte> into) const {
    std::size_t done = 0;
    while (done < into.size()) {
        const ssize_t n =
            ::pread(fd_, into.data() + done, into.size() - done, off_t(offset + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail(path_, "read");
        if (n == 0) break;
        done += std::size_t(n);
    }
    return done;
}

}  // namespace eventide
