// One writer at a time of a file or folder.
#include "src/io/file_lock.h"

#include "src/core/error.h"
#include "src/io/output_paths.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace eventide {

bool lock_file(int descriptor) {
    return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

void unlock_file(int descriptor) {
    ::flock(descriptor, LOCK_UN);
}

bool is_locked(const std::filesystem::path& file) {
    const int opened = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    const bool locked = ::flock(opened, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (opened >= 0) ::close(opened);
    return locked;
}

FolderLock::~FolderLock() {
    std::error_code holds_something;
    if (!made_.empty()) std::filesystem::remove(made_, holds_something);
    if (folder_ >= 0) ::close(folder_);
}

void FolderLock::take(const std::filesystem::path& folder) {
    const bool is_new = create_folder(folder);
    folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (!lock_file(folder_))
        throw Error(ErrorKind::usage, folder.string() +
                                          ": expected a folder that no other run writes to, found "
                                          "one that another writes to now");
    if (is_new) made_ = folder;
}

}  // namespace eventide
