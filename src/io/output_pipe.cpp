// A pipe being written: whoever reads it may come late, fall behind, or go away.
#include "src/io/output_file.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>

namespace eventide {

namespace {

constexpr int kAskAgainMs = 20, kMostAsked = 50;

}  // namespace

std::string_view text_of(PipeReader reader) {
    switch (reader) {
        case PipeReader::never_came:
            return "nobody read it";
        case PipeReader::stalled:
            return "its reader took nothing any more";
        case PipeReader::left:
            return "its reader went away";
        case PipeReader::takes:
            break;
    }
    return "its reader took it";
}

/// open() of a pipe without a reader would wait where no signal can end it, and so would write() of
/// one that is full; so both are asked again and again.
void OutputFile::open_pipe() {
    for (;;) {
        file_ = ::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
        if (file_ >= 0) return;
        if (errno != ENXIO) fail("opened", errno);
        if (give_up_ && give_up_()) return lose_reader(PipeReader::never_came);
        ::poll(nullptr, 0, kAskAgainMs);
    }
}

/// A pipe that is somebody else's, so that not to wait for its reader is a matter of ours alone.
void OutputFile::open_again() {
    const std::string again = "/proc/self/fd/" + std::to_string(file_);
    const int file = ::open(again.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) return;
    file_ = file;
    owned_ = true;
}

void OutputFile::hold_at_most(std::size_t bytes) {
    const int most = ::fcntl(file_, F_GETPIPE_SZ);  // an error for what is no pipe
    if (most > 0 && bytes < std::size_t(most)) ::fcntl(file_, F_SETPIPE_SZ, int(bytes));
}

bool OutputFile::takes_at_once() const {
    pollfd asked{file_, POLLOUT, 0};
    return ::poll(&asked, 1, 0) != 0;
}

/// `asked`: how often somebody wanted to give up since the reader last took something. False once
/// that is long enough.
bool OutputFile::wait_for_room(int& asked) {
    pollfd waiting{file_, POLLOUT, 0};
    ::poll(&waiting, 1, kAskAgainMs);
    if (!give_up_ || !give_up_()) return true;
    return ++asked < kMostAsked;
}

void OutputFile::lose_reader(PipeReader why) {
    reader_ = why;
    if (unread_) unread_(name_, why);
}

}  // namespace eventide
