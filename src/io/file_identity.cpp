// Which file a path leads to, by whatever name or link.
#include "src/io/file_identity.h"

#include <sys/stat.h>
#include <algorithm>

namespace eventide {

namespace fs = std::filesystem;

namespace {

constexpr int kMaxLinks = 40;  // as Linux: more are a circle

bool can_be_shared(mode_t mode) {
    return !S_ISREG(mode) && !S_ISDIR(mode) && !S_ISFIFO(mode) && !S_ISBLK(mode);
}

/// "folder/" is the folder, also before it is made.
fs::path without_slash(const fs::path& path) {
    return path.has_filename() ? path : path.parent_path();
}

}  // namespace

fs::path resolved(const fs::path& path) {
    std::error_code failed;
    fs::path file = fs::absolute(path, failed);
    if (failed) return path;
    for (int links = 0; links < kMaxLinks && fs::is_symlink(file, failed); ++links) {
        const fs::path target = fs::read_symlink(file, failed);
        if (failed) break;
        file = file.parent_path() / target;
    }
    const fs::path whole = fs::weakly_canonical(file, failed);
    return without_slash(failed ? file.lexically_normal() : whole);
}

FileIdentity FileIdentity::of(const fs::path& path) {
    FileIdentity identity;
    struct stat facts {};
    // As given first: the system itself follows links such as /dev/stdout, which name no path.
    if (::stat(path.c_str(), &facts) == 0) {
        identity.device_ = facts.st_dev;
        identity.inode_ = facts.st_ino;
        identity.shared_ = can_be_shared(facts.st_mode);
        identity.folder_ = S_ISDIR(facts.st_mode);
        return identity;
    }
    fs::path folder = resolved(path);
    do {
        identity.to_make_ =
            identity.to_make_.empty() ? folder.filename() : folder.filename() / identity.to_make_;
        folder = folder.parent_path();
    } while (::stat(folder.c_str(), &facts) != 0 && folder.has_relative_path());
    identity.device_ = facts.st_dev;
    identity.inode_ = facts.st_ino;
    return identity;
}

FileIdentity FileIdentity::of_descriptor(int descriptor) {
    FileIdentity identity;
    struct stat facts {};
    // A socket or terminal at both ends of a program is the shell's business.
    identity.shared_ = ::fstat(descriptor, &facts) != 0 || can_be_shared(facts.st_mode);
    identity.device_ = facts.st_dev;
    identity.inode_ = facts.st_ino;
    return identity;
}

bool FileIdentity::is_same_file(const FileIdentity& other) const {
    return !shared_ && !other.shared_ && device_ == other.device_ && inode_ == other.inode_ &&
           to_make_ == other.to_make_;
}

bool lies_in(const fs::path& path, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
           folder.end();
}

}  // namespace eventide
