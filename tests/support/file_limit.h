// A disk that is full after so many bytes, for the files of this process.
#pragma once

#include <signal.h>
#include <sys/resource.h>

namespace eventide::test {

/// No file may grow beyond `bytes` while this lives: writing fails with EFBIG, as it does with
/// ENOSPC on a full disk, but at a byte that the test chooses.
class FileLimit {
public:
    explicit FileLimit(rlim_t bytes) : handler_{signal(SIGXFSZ, SIG_IGN)} {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        signal(SIGXFSZ, handler_);
    }
    FileLimit(const FileLimit&) = delete;
    FileLimit& operator=(const FileLimit&) = delete;

private:
    sighandler_t handler_;
    rlimit before_{};
};

}  // namespace eventide::test
