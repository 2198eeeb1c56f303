// What the operating system said, in words.
#include "src/io/system_words.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace eventide {

std::string system_words(int error) {
    std::string words = std::generic_category().message(error);
    switch (error) {
        case EMFILE:
            return words + " in this process; ulimit -n raises the limit";
        case EFBIG:
            return words + " for the file system or the limit of ulimit -f";
        case EAGAIN:  // of threads; writing waits instead
            return words + ": no memory for a thread (ulimit -v), or too many of them (ulimit -u)";
        default:
            return words;
    }
}

std::string system_words(const std::system_error& error) {
    const bool no_thread = error.code() == std::errc::resource_unavailable_try_again;
    return no_thread ? system_words(EAGAIN) : error.what();
}

bool out_of_descriptors(int needed) {
    if (needed == 0) return false;
    const int probe = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (probe < 0) return errno == EMFILE || errno == ENFILE;
    const bool out = out_of_descriptors(needed - 1);
    ::close(probe);
    return out;
}

}  // namespace eventide
