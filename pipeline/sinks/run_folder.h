// A folder that a run fills, with a record of what is the run's, so that the next one replaces that
// and nothing else.
#pragma once

#include "src/io/file_lock.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

/// The record: JSON with "program", "files" (how many of each numbered kind), "single" (names of
/// the others) and "finished".
constexpr const char* kRunRecord = "run.json";

/// Files numbered from 0, such as frames/frame_0000000000.png.
struct NumberedFiles {
    std::string folder, prefix;
    int digits = 0;
    std::string extension;

    std::string name(std::uint64_t n) const;
    /// The number in a name of this kind.
    std::optional<std::uint64_t> number_in(const std::string& name) const;
};

/// What one kind of run writes.
struct RunFolderFiles {
    std::vector<NumberedFiles> numbered;  ///< the first is what the others belong to
    std::vector<std::string> single;
    /// One of `single` with a line at least for each number: says how far a killed run came.
    std::string list;
    /// Those of `single` that records without "single" do not mean: earlier versions wrote none.
    std::vector<std::string> since_named = {};
};

class RunFolder {
public:
    /// Makes the folder; where it stays empty it goes again. With `overwrite` it may hold an
    /// earlier run's files, which stay until begin(). Throws Error: usage for a folder that another
    /// run writes to, that holds something, without `overwrite`, or holds a file that would be
    /// replaced and is not an earlier run's by its record; failed when it cannot be made or written
    /// to.
    RunFolder(std::filesystem::path folder, bool overwrite, RunFolderFiles files);

    const std::filesystem::path& path() const { return folder_; }

    /// The first thing is about to be written: an earlier run's files go. Throws Error (failed).
    void begin();
    /// An earlier run is still there, whole.
    bool holds_earlier_run() const { return !begun_ && !earlier_.empty(); }

    /// Folder, subfolder and name of one more file of a kind; the subfolder is made for the first.
    /// After begin().
    std::filesystem::path next(std::size_t kind);

    /// Ends the record; `about` is a JSON object to put in it. After begin(). Throws Error
    /// (failed).
    void finish(const std::string& about = "{}") { write_record(about, true); }

private:
    void prepare(bool overwrite);
    void write_record(const std::string& about, bool finished) const;

    std::filesystem::path folder_;
    RunFolderFiles files_;
    FolderLock lock_;
    std::vector<std::filesystem::path> earlier_;  // an earlier run's
    bool begun_ = false;
    std::vector<std::uint64_t> written_;  // of each kind
};

}  // namespace eventide
