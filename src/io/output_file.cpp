// A file being written: made beside its name and renamed, or growing under it.
#include "src/io/output_file.h"

#include "src/core/error.h"
#include "src/io/file_identity.h"
#include "src/io/file_lock.h"
#include "src/io/stream_name.h"
#include "src/io/system_words.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace eventide {

namespace fs = std::filesystem;

namespace {

constexpr mode_t kMode = 0666;             // less what umask takes
constexpr int kMaxParts = 1000;            // left behind by as many killed runs
constexpr std::size_t kLongestStem = 240;  // bytes: with .part below what a name may have

}  // namespace

void OutputFile::fail(const char* doing, int error) const {
    throw Error(ErrorKind::failed, name_ + ": cannot be " + doing + ": " + system_words(error));
}

OutputFile::OutputFile(const fs::path& path, const OutputOptions& options)
    : name_{output_name(path.string())}, give_up_{options.give_up}, unread_{options.unread} {
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

void OutputFile::write(std::span<const std::byte> bytes) {
    if (!is_read()) return;
    begin();
    int asked = 0;
    while (!bytes.empty()) {
        const ssize_t n = ::write(file_, bytes.data(), bytes.size());
        if (n >= 0) {
            bytes = bytes.subspan(std::size_t(n));
            asked = 0;
        } else if (errno == EPIPE) {
            return lose_reader(PipeReader::left);
        } else if (errno == EAGAIN) {  // ours, or standard output that others made non-blocking
            if (!wait_for_room(asked)) return lose_reader(PipeReader::stalled);
        } else if (errno != EINTR) {
            fail("written", errno);
        }
    }
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

void write_file(const fs::path& path, std::span<const std::byte> bytes, bool overwrite) {
    OutputFile file{path, {.overwrite = overwrite}};
    file.write(bytes);
    file.close();
}

void write_file(const fs::path& path, std::string_view text, bool overwrite) {
    write_file(path, std::as_bytes(std::span{text}), overwrite);
}

}  // namespace eventide
