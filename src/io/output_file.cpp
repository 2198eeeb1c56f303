// A file being written: made beside its name and renamed, or growing under it.
#include "src/io/output_file.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/file_identity.h"
#include "src/io/file_lock.h"
#include "src/io/system_words.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <optional>
#include <utility>

namespace eventide {

namespace fs = std::filesystem;

namespace {

constexpr mode_t kMode = 0666;   // less what umask takes
constexpr int kMaxParts = 1000;  // left behind by as many killed runs
constexpr int kAskAgainMs = 20, kMostAsked = 50;
constexpr std::size_t kLongestStem = 240;  // bytes: with .part below what a name may have

/// Of an open file that the path stands for: what was written to it before, by whomever, stays.
std::optional<int> descriptor_named(const fs::path& path) {
    if (path == "-" || path == "/dev/stdout") return STDOUT_FILENO;
    if (path == "/dev/stderr") return STDERR_FILENO;
    if (path.parent_path() != "/dev/fd" && path.parent_path() != "/proc/self/fd") return {};
    const std::string name = path.filename().string();
    const auto number = number_in<int>(name);
    return number && std::to_string(*number) == name ? number : std::nullopt;  // not "09"
}

Error existing_file(const std::string& name) {
    return {ErrorKind::usage,
            name + ": exists already; --overwrite (in the library overwrite) replaces it"};
}

}  // namespace

void OutputFile::fail(const char* doing, int error) const {
    throw Error(ErrorKind::failed, name_ + ": cannot be " + doing + ": " + system_words(error));
}

OutputFile::OutputFile(const fs::path& path, const OutputOptions& options)
    : name_{path == "-" ? "standard output" : path.string()}, give_up_{options.give_up} {
    struct stat facts {};
    if (const auto descriptor = descriptor_named(path)) {
        owned_ = false;
        file_ = *descriptor;
        if (::fstat(file_, &facts) != 0) fail("written", errno);
        // In a file opened for appending (>>) every write goes to the end.
        seekable_ = S_ISREG(facts.st_mode) && ::lseek(file_, 0, SEEK_CUR) == 0 &&
                    (::fcntl(file_, F_GETFL) & O_APPEND) == 0;
        if (S_ISFIFO(facts.st_mode) && give_up_) open_again();
        return;
    }
    refuse_existing(path, options.overwrite);
    const bool exists = ::stat(path.c_str(), &facts) == 0;
    // What is made beside it has a shorter name, and would only in the end find none for it.
    if (!exists && errno == ENAMETOOLONG) fail("created", errno);
    path_ = exists && !S_ISREG(facts.st_mode) ? path : resolved(path);
    if (exists && S_ISFIFO(facts.st_mode)) {
        open_pipe();
    } else if (exists && !S_ISREG(facts.st_mode)) {
        file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
        if (file_ < 0) fail("opened", errno);
    } else if (options.appears == Appears::growing) {
        open_growing(options.overwrite);
    } else {
        replaces_ = exists;
        had_earlier_ = exists && facts.st_size > 0;
        open_beside(options.overwrite);
    }
}

OutputFile::~OutputFile() {
    if (owned_ && file_ >= 0) ::close(file_);
    forget_new_file();
}

/// open() of a pipe without a reader would wait where no signal can end it, and so would write() of
/// one that is full; so both are asked again and again.
void OutputFile::open_pipe() {
    for (;;) {
        file_ = ::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC);
        if (file_ >= 0) return;
        if (errno != ENXIO) fail("opened", errno);
        if (give_up_ && give_up_()) {
            reader_gone_ = true;
            return;
        }
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

void OutputFile::open_growing(bool overwrite) {
    seekable_ = true;
    file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
    made_ = file_ >= 0;
    if (made_) return take_alone();
    if (errno != EEXIST) fail("created", errno);
    file_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    struct stat facts {};
    if (file_ < 0 || ::fstat(file_, &facts) != 0) fail("opened", errno);
    take_alone();
    // Made by another since refuse_existing() looked.
    if (facts.st_size > 0 && !overwrite) {
        ::close(std::exchange(file_, -1));
        throw existing_file(name_);
    }
    has_other_names_ = facts.st_nlink > 1;
}

/// The bytes of two who write at once would be mixed.
void OutputFile::take_alone() {
    if (lock_file(file_)) return;
    ::close(std::exchange(file_, -1));
    throw Error(ErrorKind::usage,
                name_ +
                    ": expected a file that nobody else writes, found one that another program "
                    "writes now");
}

void OutputFile::open_beside(bool overwrite) {
    seekable_ = true;
    struct stat facts {};
    if (replaces_ && (::stat(path_.c_str(), &facts) != 0 || ::access(path_.c_str(), W_OK) != 0))
        fail("replaced", errno);
    const std::string stem = path_.filename().string().substr(0, kLongestStem) + ".part";
    for (int n = 1; file_ < 0; ++n) {
        part_ = path_.parent_path() / (n == 1 ? stem : stem + std::to_string(n));
        file_ = ::open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
        if (file_ >= 0 || (errno == EEXIST && n < kMaxParts)) continue;
        const int error = errno;
        part_.clear();
        fail("created", error);
    }
    if (replaces_) ::fchmod(file_, facts.st_mode & 07777);
    replaces_ = replaces_ || overwrite;
}

/// What the file held goes with the first byte that takes its place; under its other names (hard
/// links) it stays.
void OutputFile::begin() {
    if (std::exchange(begun_, true) || !owned_ || !seekable_ || made_ || !part_.empty()) return;
    if (has_other_names_) {
        ::close(std::exchange(file_, -1));
        replaces_ = true;
        open_beside(true);
        take_alone();
        publish();
    } else if (::ftruncate(file_, 0) != 0) {
        fail("emptied", errno);
    }
}

void OutputFile::hold_at_most(std::size_t bytes) {
    const int most = ::fcntl(file_, F_GETPIPE_SZ);  // an error for what is no pipe
    if (most > 0 && bytes < std::size_t(most)) ::fcntl(file_, F_SETPIPE_SZ, int(bytes));
}

bool OutputFile::takes_at_once() const {
    pollfd asked{file_, POLLOUT, 0};
    return ::poll(&asked, 1, 0) != 0;
}

void OutputFile::write(std::span<const std::byte> bytes) {
    if (reader_gone_) return;
    begin();
    int asked = 0;
    while (!bytes.empty()) {
        const ssize_t n = ::write(file_, bytes.data(), bytes.size());
        if (n >= 0) {
            bytes = bytes.subspan(std::size_t(n));
            asked = 0;
        } else if (errno == EPIPE) {
            reader_gone_ = true;
            return;
        } else if (errno == EAGAIN) {  // ours, or standard output that others made non-blocking
            if (!wait_for_room(asked)) {
                reader_gone_ = true;
                return;
            }
        } else if (errno != EINTR) {
            fail("written", errno);
        }
    }
}

/// `asked`: how often somebody wanted to give up since the reader last took something. False once
/// that is long enough.
bool OutputFile::wait_for_room(int& asked) {
    pollfd waiting{file_, POLLOUT, 0};
    ::poll(&waiting, 1, kAskAgainMs);
    if (!give_up_ || !give_up_()) return true;
    return ++asked < kMostAsked;
}

void OutputFile::write(std::string_view text) {
    write(std::as_bytes(std::span{text}));
}

void OutputFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t n = ::pwrite(file_, bytes.data(), bytes.size(), off_t(offset));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail("written", errno);
        bytes = bytes.subspan(std::size_t(n));
        offset += std::uint64_t(n);
    }
}

std::uint64_t OutputFile::size() const {
    struct stat facts {};
    if (::fstat(file_, &facts) != 0) fail("examined", errno);
    return std::uint64_t(facts.st_size);
}

std::string OutputFile::path_to_reopen() {
    begin();
    unlock_file(file_);  // HDF5 takes a lock of its own
    return "/proc/self/fd/" + std::to_string(file_);
}

void OutputFile::publish() {
    if (part_.empty()) return;
    rename_part();
    part_.clear();
}

void OutputFile::rename_part() {
    if (replaces_) {
        if (::rename(part_.c_str(), path_.c_str()) != 0) fail("renamed", errno);
        return;
    }
    // Another may have made a file of that name meanwhile: it stays.
    if (::renameat2(AT_FDCWD, part_.c_str(), AT_FDCWD, path_.c_str(), RENAME_NOREPLACE) == 0)
        return;
    if (errno == EEXIST) throw existing_file(name_);
    if (errno != EINVAL && errno != ENOSYS) fail("renamed", errno);
    // Not every file system knows that flag.
    refuse_existing(path_, false);
    if (::rename(part_.c_str(), path_.c_str()) != 0) fail("renamed", errno);
}

/// On the disk, before the file from before goes: or a power cut soon after leaves neither of them.
void OutputFile::bring_to_disk() {
    if (part_.empty() || !had_earlier_ || file_ < 0) return;
    while (::fdatasync(file_) != 0)
        if (errno != EINTR) {
            if (errno == EINVAL || errno == ENOSYS) return;  // file systems that know no such thing
            fail("written", errno);
        }
}

void OutputFile::close() {
    bring_to_disk();
    // Before the renaming: some file systems say only now that there was no space.
    if (owned_ && file_ >= 0 && ::close(std::exchange(file_, -1)) != 0) fail("written", errno);
    publish();
    forget_new_file();
}

void OutputFile::forget_new_file() {
    if (!part_.empty()) ::unlink(std::exchange(part_, {}).c_str());
    if (std::exchange(made_, false) && !begun_) ::unlink(path_.c_str());
}

void refuse_existing(const fs::path& path, bool overwrite) {
    if (path.empty())
        throw Error(ErrorKind::usage, "output: expected the name of a file, found none");
    std::error_code none;
    if (fs::is_directory(path, none))
        throw Error(ErrorKind::usage, path.string() + ": expected a file, found a folder");
    if (!overwrite && would_replace(path)) throw existing_file(path.string());
}

bool would_replace(const fs::path& path) {
    std::error_code none;
    return fs::is_regular_file(path, none) && !names_open_file(path) &&
           fs::file_size(path, none) > 0;
}

bool names_open_file(const fs::path& path) {
    return descriptor_named(path).has_value();
}

bool create_folder(const fs::path& path) {
    std::error_code error;
    const bool created = fs::create_directories(path, error);
    if (error)
        throw Error(ErrorKind::failed,
                    path.string() + ": cannot be created: " + system_words(error.value()));
    return created;
}

void write_file(const fs::path& path, std::span<const std::byte> bytes, bool overwrite) {
    OutputFile file{path, {.overwrite = overwrite}};
    file.write(bytes);
    file.close();
}

void write_file(const fs::path& path, std::string_view text, bool overwrite) {
    write_file(path, std::as_bytes(std::span{text}), overwrite);
}

}  // namespace eventide
