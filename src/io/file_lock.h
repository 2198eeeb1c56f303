// One writer at a time of a file or folder: locks of the system, which only who asks heeds.
#pragma once

#include <filesystem>

namespace eventide {

/// An open file (or folder) is its writer's until it is closed or unlock_file(). False where
/// another has it; where the file system knows no locks, true.
bool lock_file(int descriptor);
void unlock_file(int descriptor);

/// Whether another writer has the file.
bool is_locked(const std::filesystem::path& file);

/// Holds a folder that one run fills, for as long as it does; one that it made and left empty goes.
class FolderLock {
public:
    FolderLock() = default;
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

    /// Makes it, too, where there is none. Throws Error: usage where another holds it, failed where
    /// it cannot be made.
    void take(const std::filesystem::path& folder);

private:
    std::filesystem::path made_;  // empty: it was there
    int folder_ = -1;
};

}  // namespace eventide
