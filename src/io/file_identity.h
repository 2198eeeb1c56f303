// Which file a path leads to, by whatever name or link.
#pragma once

#include <sys/types.h>

#include <filesystem>

namespace eventide {

/// `path` absolute, without links and a slash at its end, as far as it exists; what is still to be
/// made is kept as written. A link that leads to nothing is followed, since opening it for writing
/// makes its target.
std::filesystem::path resolved(const std::filesystem::path& path);

/// Two paths are the same file when device and inode are, or, where neither exists yet, when the
/// same name would be made in the same folder.
class FileIdentity {
public:
    static FileIdentity of(const std::filesystem::path& path);
    /// The identity of an open file, such as standard output.
    static FileIdentity of_descriptor(int descriptor);

    /// Never for terminals, sockets and devices such as /dev/null: any number of users may share
    /// those.
    bool is_same_file(const FileIdentity& other) const;
    bool is_folder() const { return folder_; }

private:
    bool shared_ = false, folder_ = false;
    dev_t device_ = 0;               // of the file, or of the deepest folder that exists
    ino_t inode_ = 0;                // likewise
    std::filesystem::path to_make_;  // below that folder; empty where the file exists
};

/// Whether `path` is the folder or lies anywhere below it; both resolved().
bool lies_in(const std::filesystem::path& path, const std::filesystem::path& folder);

}  // namespace eventide
