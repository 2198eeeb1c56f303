// The files a command was told to read and to write, so that no output lands on an input or on
// another output.
#pragma once

#include "src/io/file_identity.h"

#include <filesystem>
#include <string>
#include <vector>

namespace eventide {

/// Files are compared as the system knows them, so that links do not hide that two names are one
/// file. All are named before anything is opened for writing.
class NamedFiles {
public:
    /// Whether what exists may be replaced (--overwrite).
    void may_replace(bool overwrite) { overwrite_ = overwrite; }

    /// `option` as the user wrote it: "--model"; an empty path is nothing, "-" standard input.
    /// Throws Error (usage) where it is an output.
    void reads(const std::string& option, const std::filesystem::path& path);
    /// A folder and everything in it.
    void reads_all(const std::string& option, const std::filesystem::path& folder);

    /// One file; an empty path is nothing, "-" standard output. Throws Error (usage) naming both
    /// where it is also an input or another output (two on standard output would mix their bytes);
    /// for a file with something in it that may not be replaced; and where there is no folder for
    /// it, and none that an output named before makes.
    /// `said` is how the user wrote it, where that is not just the path: "y4m:x".
    void writes(const std::string& option, const std::filesystem::path& path,
                const std::string& said = {});
    /// As writes(), of what a command writes when all its work is done: also refused where its
    /// folder cannot be written to (kind failed).
    void writes_when_done(const std::string& option, const std::filesystem::path& path,
                          const std::string& said = {});
    /// Those outputs of writes() that are named pipes.
    const std::vector<std::filesystem::path>& pipes() const { return pipes_; }
    /// A folder that a command makes where there is none, of which the files are named one by one.
    void writes_folder(const std::string& option, const std::filesystem::path& folder);
    /// A folder for what a command makes when all its work is done, which may hold other things,
    /// too: refused where something else has its name, or it cannot be made or written to (kind
    /// failed).
    void expect_folder(const std::string& option, const std::filesystem::path& folder);
    /// A folder that is the output's own, with everything in it.
    void writes_all(const std::string& option, const std::filesystem::path& folder);

    /// Throws Error (usage) for a path that begins with ~: no shell replaces it in a configuration
    /// file, the environment or `--out=~/x`, and the output would land in a folder of that name.
    /// `said` is how the user wrote it.
    static void refuse_home_sign(const std::string& said, const std::filesystem::path& path);

private:
    struct Named {
        std::string text;            ///< "--out x.mp4"
        std::filesystem::path path;  ///< resolved; empty for standard input and output
        FileIdentity identity;
        bool whole_folder = false;
    };
    void name_output(const std::string& option, const std::filesystem::path& path,
                     const std::string& said);
    static Named named(std::string text, const std::filesystem::path& path);
    static void refuse_standard_streams(const std::string& said, const std::filesystem::path& path);
    static void refuse_overlap(const Named& named, const std::vector<Named>& others);
    void add(Named named, std::vector<Named>& to);
    void expect_folder_of(const std::string& said, const std::filesystem::path& file) const;
    static void expect_room_for(const std::string& said, const std::filesystem::path& path);

    bool overwrite_ = false;
    std::string standard_output_;  ///< which output has it
    std::vector<Named> inputs_, outputs_;
    std::vector<std::filesystem::path> pipes_;
    std::vector<std::filesystem::path> made_;  ///< folders; resolved
};

}  // namespace eventide
