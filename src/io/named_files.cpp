// The files a command was told to read and to write.
#include "src/io/named_files.h"

#include "src/core/error.h"
#include "src/io/output_file.h"
#include "src/io/system_words.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace eventide {

namespace fs = std::filesystem;

void NamedFiles::refuse_home_sign(const std::string& said, const fs::path& path) {
    if (!path.empty() && *path.begin() == "~")
        throw Error(ErrorKind::usage,
                    said +
                        ": expected the whole path, found ~, which only a shell replaces by the "
                        "home folder; ./~ is a file or folder of that name");
}

NamedFiles::Named NamedFiles::named(std::string text, const fs::path& path) {
    return {std::move(text), resolved(path), FileIdentity::of(path)};
}

void NamedFiles::refuse_overlap(const Named& named, const std::vector<Named>& others) {
    const auto holds = [](const Named& folder, const Named& file) {
        return folder.whole_folder && lies_in(file.path, folder.path);
    };
    const auto refuse = [&](const Named& other, bool same) {
        const std::string kind = named.identity.is_folder() ? "folder" : "file";
        throw Error(ErrorKind::usage,
                    named.text +
                        (same ? ": is the same " + kind + " as " : ": is in the same folder as ") +
                        other.text + "; expected a " + kind + " of its own");
    };
    for (const Named& other : others) {
        const bool same = named.identity.is_same_file(other.identity);
        if (same || holds(named, other) || holds(other, named)) refuse(other, same);
    }
}

/// Which have a place of their own in the file, and write over what the output writes there.
void NamedFiles::refuse_standard_streams(const std::string& said, const fs::path& path) {
    const FileIdentity file = FileIdentity::of(path);
    for (const auto& [descriptor, name] :
         {std::pair{STDOUT_FILENO, "standard output"}, {STDERR_FILENO, "standard error"}})
        if (file.is_same_file(FileIdentity::of_descriptor(descriptor)))
            throw Error(ErrorKind::usage,
                        said + ": is the same file as " + name + "; expected a file of its own");
}

void NamedFiles::add(Named named, std::vector<Named>& to) {
    if (&to == &outputs_) refuse_overlap(named, inputs_);
    refuse_overlap(named, outputs_);
    to.push_back(std::move(named));
}

void NamedFiles::reads(const std::string& option, const fs::path& path) {
    if (path == "-")
        add({option + " -", {}, FileIdentity::of_descriptor(STDIN_FILENO)}, inputs_);
    else if (!path.empty())
        add(named(option + " " + path.string(), path), inputs_);
}

void NamedFiles::reads_all(const std::string& option, const fs::path& folder) {
    Named all = named(option + " " + folder.string(), folder);
    all.whole_folder = true;
    add(std::move(all), inputs_);
}

void NamedFiles::writes(const std::string& option, const fs::path& path, const std::string& said) {
    name_output(option, path, said);
    std::error_code none;
    if (fs::is_fifo(path, none)) pipes_.push_back(path);
}

void NamedFiles::name_output(const std::string& option, const fs::path& path,
                             const std::string& said) {
    if (path.empty()) return;
    if (path == "-") {
        if (!standard_output_.empty())
            throw Error(ErrorKind::usage, option + " -: " + standard_output_ +
                                              " has standard output; expected another file");
        standard_output_ = option + " -";
        return add({standard_output_, {}, FileIdentity::of_descriptor(STDOUT_FILENO)}, outputs_);
    }
    const std::string text = option + " " + (said.empty() ? path.string() : said);
    refuse_home_sign(text, path);
    if (!names_open_file(path)) refuse_standard_streams(text, path);
    add(named(text, path), outputs_);
    refuse_existing(path, overwrite_);
    expect_folder_of(text, path);
}

void NamedFiles::expect_folder_of(const std::string& said, const fs::path& file) const {
    const fs::path folder = resolved(file).parent_path();
    std::error_code none;
    const auto status = fs::status(folder, none);
    const bool may_be_there = status.type() == fs::file_type::none || fs::is_directory(status);
    const auto holds_it = [&](const fs::path& made) { return lies_in(made, folder); };
    if (!may_be_there && std::ranges::none_of(made_, holds_it))
        throw Error(ErrorKind::usage,
                    said + ": expected a folder that exists, found no " + folder.string());
}

void NamedFiles::writes_when_done(const std::string& option, const fs::path& path,
                                  const std::string& said) {
    name_output(option, path, said);
    if (!path.empty() && path != "-")
        expect_room_for(option + " " + (said.empty() ? path.string() : said), path);
}

void NamedFiles::expect_room_for(const std::string& said, const fs::path& path) {
    // Files are written beside their place; devices and pipes are where they are. The system
    // itself follows links such as /dev/stdout, which name no path.
    std::error_code none;
    const auto status = fs::status(path, none);
    if (none == std::errc::filename_too_long)
        throw Error(ErrorKind::failed, said + ": cannot be created: " + system_words(none.value()));
    if (fs::exists(status) && !fs::is_regular_file(status)) return;
    const fs::path folder = resolved(path).parent_path();
    // What another output makes is not there yet.
    if (::faccessat(AT_FDCWD, folder.c_str(), W_OK, AT_EACCESS) != 0 && errno != ENOENT)
        throw Error(ErrorKind::failed, said + ": cannot be created: " + system_words(errno));
}

void NamedFiles::writes_folder(const std::string& option, const fs::path& folder) {
    refuse_home_sign(option + " " + folder.string(), folder);
    add(named(option + " " + folder.string(), folder), outputs_);
    made_.push_back(resolved(folder));
}

void NamedFiles::expect_folder(const std::string& option, const fs::path& folder) {
    const std::string said = option + " " + folder.string();
    refuse_home_sign(said, folder);
    std::error_code none;
    fs::path there = resolved(folder);
    while (!fs::exists(there, none) && there.has_relative_path()) there = there.parent_path();
    if (!fs::is_directory(there, none))
        throw Error(ErrorKind::usage,
                    said + ": expected a folder, found a file, " + there.string());
    if (::faccessat(AT_FDCWD, there.c_str(), W_OK, AT_EACCESS) != 0)
        throw Error(ErrorKind::failed, said + ": cannot be written to: " + system_words(errno));
    made_.push_back(resolved(folder));
}

void NamedFiles::writes_all(const std::string& option, const fs::path& folder) {
    refuse_home_sign(option + " " + folder.string(), folder);
    Named all = named(option + " " + folder.string(), folder);
    all.whole_folder = true;
    add(std::move(all), outputs_);
}

}  // namespace eventide
