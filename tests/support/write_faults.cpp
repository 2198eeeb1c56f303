// Preloaded into a program: the n-th write into a file and all after it find the disk full, the
// n-th write is where the program is killed, or the disk cannot take what was written.
//   EVENTIDE_FAULT         full, kill or lost; else writes are only counted
//   EVENTIDE_FAULT_AT      n, from 0
//   EVENTIDE_FAULT_COUNT   a file that holds the number of writes so far
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> g_writes{0};

long number_in(const char* variable) {
    const char* text = std::getenv(variable);
    return text == nullptr ? -1 : std::atol(text);
}

bool says(const char* variable, const char* word) {
    const char* text = std::getenv(variable);
    return text != nullptr && std::strcmp(text, word) == 0;
}

/// Standard streams, pipes and devices are no disk.
bool is_on_disk(int file) {
    struct stat facts {};
    return file > STDERR_FILENO && fstat(file, &facts) == 0 && S_ISREG(facts.st_mode);
}

void note(long writes) {
    static const char* const path = std::getenv("EVENTIDE_FAULT_COUNT");
    static const int file =
        path == nullptr ? -1 : open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (file < 0) return;
    char text[24];
    const int n = std::snprintf(text, sizeof text, "%20ld\n", writes);
    syscall(SYS_pwrite64, file, text, n, 0);
}

/// Whether this write is to fail; does not return where the program is to be killed.
bool fails(int file) {
    static const bool is_full = says("EVENTIDE_FAULT", "full");
    static const bool kills = says("EVENTIDE_FAULT", "kill");
    static const long at = number_in("EVENTIDE_FAULT_AT");
    if (!is_on_disk(file)) return false;
    const long n = g_writes++;
    note(n + 1);
    if (kills && n == at) raise(SIGKILL);
    return is_full && n >= at;
}

ssize_t positioned(int file, const void* bytes, size_t n, off_t offset) {
    if (!fails(file)) return syscall(SYS_pwrite64, file, bytes, n, offset);
    errno = ENOSPC;
    return -1;
}

}  // namespace

extern "C" {

ssize_t write(int file, const void* bytes, size_t n) {
    if (!fails(file)) return syscall(SYS_write, file, bytes, n);
    errno = ENOSPC;
    return -1;
}
ssize_t pwrite(int file, const void* bytes, size_t n, off_t offset) {
    return positioned(file, bytes, n, offset);
}
ssize_t pwrite64(int file, const void* bytes, size_t n, off_t offset) {
    return positioned(file, bytes, n, offset);
}
int fdatasync(int file) {
    static const bool is_lost = says("EVENTIDE_FAULT", "lost");
    if (!is_lost) return int(syscall(SYS_fdatasync, file));
    errno = EIO;
    return -1;
}
}
