// A folder that a run fills, with a record of what is the run's.
#include "pipeline/sinks/run_folder.h"

#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/io/output_file.h"
#include "src/io/shallow_json.h"
#include "src/io/system_words.h"

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <set>
#include <system_error>
#include <utility>

namespace eventide {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;

namespace {

/// What is an earlier run's.
struct Owned {
    std::map<std::string, std::uint64_t> numbered;  // how many of each kind
    std::set<std::string> single;
};

std::uint64_t lines_in(const fs::path& file) {
    std::ifstream stream{file};
    return std::uint64_t(std::count(std::istreambuf_iterator<char>{stream}, {}, '\n'));
}

std::set<std::string> single_in(const Json& record, const RunFolderFiles& files) {
    if (const Json named = record.value("single", Json{}); named.is_array()) {
        std::set<std::string> names;
        for (const Json& name : named)
            if (name.is_string()) names.insert(name.get<std::string>());
        return names;
    }
    std::set<std::string> names{files.single.begin(), files.single.end()};
    for (const std::string& name : files.since_named) names.erase(name);
    return names;
}

/// What the record says; nothing where there is none, or one of another program or another kind of
/// run.
std::optional<Owned> read_record(const fs::path& folder, const RunFolderFiles& files) {
    std::ifstream stream{folder / kRunRecord};
    const Json record = parse_shallow_json<Json>(stream);
    if (!record.is_object() || !record.contains("program") || !record["program"].is_string() ||
        !record["program"].get<std::string>().starts_with("eventide"))
        return std::nullopt;
    const Json counts = record.value("files", Json{});
    const std::string& first = files.numbered.front().folder;
    // Records without counts are of runs that wrote frames.
    if (counts.is_object() ? !counts.contains(first) : first != "frames") return std::nullopt;
    Owned owned{.numbered = {}, .single = single_in(record, files)};
    for (const NumberedFiles& kind : files.numbered) {
        const Json count = counts.is_object() ? counts.value(kind.folder, Json{}) : Json{};
        owned.numbered[kind.folder] =
            record.value("finished", Json{}) == true && count.is_number_unsigned()
                ? count.get<std::uint64_t>()
                : lines_in(folder / files.list);
    }
    return owned;
}

/// Existing files of one kind, by number; also what a killed run left beside (OutputFile).
std::multimap<std::uint64_t, fs::path> numbered_in(const fs::path& folder,
                                                   const NumberedFiles& kind) {
    std::multimap<std::uint64_t, fs::path> found;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator{folder / kind.folder, none}) {
        const fs::path name = entry.path().filename();
        const fs::path whole = name.extension() == ".part" ? name.stem() : name;
        if (const auto n = kind.number_in(whole.string())) found.emplace(*n, entry.path());
    }
    return found;
}

[[noreturn]] void refuse(const fs::path& file) {
    throw Error(ErrorKind::usage,
                file.string() + ": expected a file that an earlier run wrote (its " + kRunRecord +
                    " says which), found another; --overwrite does not replace it");
}

/// Those that held them alone go with them; next() makes what is wanted again.
void remove_empty_folders(const fs::path& folder, const std::vector<fs::path>& of) {
    for (const fs::path& file : of) {
        const fs::path parent = file.parent_path();
        std::error_code holds_something;
        if (parent != folder && fs::is_directory(fs::symlink_status(parent)))
            fs::remove(parent, holds_something);
    }
}

/// The existing files that this run would replace or mix with its own, all of an earlier run.
std::vector<fs::path> earlier_files(const fs::path& folder, const RunFolderFiles& files) {
    const auto owned = read_record(folder, files);
    std::vector<fs::path> found;
    const auto take = [&](const fs::path& file, bool is_ours) {
        if (!is_ours) refuse(file);
        found.push_back(file);
    };
    for (const std::string& name : files.single) {
        const bool is_ours = owned && owned->single.contains(name);
        if (fs::exists(fs::symlink_status(folder / name))) take(folder / name, is_ours);
        if (is_ours && fs::exists(folder / (name + ".part")))
            found.push_back(folder / (name + ".part"));
    }
    for (const NumberedFiles& kind : files.numbered)
        for (const auto& [n, file] : numbered_in(folder, kind))
            take(file, owned && n < owned->numbered.at(kind.folder));
    if (!owned && fs::exists(fs::symlink_status(folder / kRunRecord))) refuse(folder / kRunRecord);
    return found;
}

}  // namespace

std::string NumberedFiles::name(std::uint64_t n) const {
    std::string number = std::to_string(n);
    if (number.size() < std::size_t(digits))
        number.insert(0, std::size_t(digits) - number.size(), '0');
    return prefix + number + extension;
}

std::optional<std::uint64_t> NumberedFiles::number_in(const std::string& name) const {
    if (!name.starts_with(prefix)) return std::nullopt;
    std::string_view rest = std::string_view{name}.substr(prefix.size());
    const auto n = take_number<std::uint64_t>(rest);
    return n && this->name(*n) == name ? n : std::nullopt;
}

RunFolder::RunFolder(fs::path folder, bool overwrite, RunFolderFiles files)
    : folder_{std::move(folder)}, files_{std::move(files)}, written_(files_.numbered.size()) {
    try {
        prepare(overwrite);
    } catch (const fs::filesystem_error& error) {
        throw Error(ErrorKind::failed,
                    folder_.string() + ": cannot be read: " + system_words(error.code().value()));
    }
    if (::access(folder_.c_str(), W_OK | X_OK) != 0)
        throw Error(ErrorKind::failed, folder_.string() + ": cannot be written to: " +
                                           std::generic_category().message(errno));
}

void RunFolder::begin() {
    if (std::exchange(begun_, true)) return;
    try {
        for (const fs::path& file : earlier_) fs::remove(file);
        remove_empty_folders(folder_, earlier_);
    } catch (const fs::filesystem_error& error) {
        throw Error(ErrorKind::failed,
                    error.path1().string() + ": cannot be removed: " + error.code().message());
    }
    write_record("{}", false);
}

void RunFolder::prepare(bool overwrite) {
    // Of "x/" the system says that there is no such thing where x is a file.
    const fs::path itself = folder_.has_filename() ? folder_ : folder_.parent_path();
    if (fs::exists(itself) && !fs::is_directory(itself))
        throw Error(ErrorKind::usage, folder_.string() + ": expected a folder, found a file");
    lock_.take(folder_);
    if (!fs::is_empty(folder_)) {
        if (!overwrite)
            throw Error(ErrorKind::usage,
                        folder_.string() +
                            ": expected an empty or new folder, found one that holds something; "
                            "--overwrite replaces an earlier run");
        earlier_ = earlier_files(folder_, files_);
    }
}

fs::path RunFolder::next(std::size_t kind) {
    const NumberedFiles& files = files_.numbered[kind];
    if (written_[kind] == 0) create_folder(folder_ / files.folder);
    return folder_ / files.folder / files.name(written_[kind]++);
}

void RunFolder::write_record(const std::string& about, bool finished) const {
    Json record = Json::parse(about);
    if (!record.contains("program")) record["program"] = "eventide";
    for (std::size_t i = 0; i < written_.size(); ++i)
        record["files"][files_.numbered[i].folder] = written_[i];
    // Of a run that is killed, all that it may write: nothing else has such a name when it begins.
    record["single"] = Json::array();
    for (const std::string& name : files_.single)
        if (!finished || fs::exists(folder_ / name)) record["single"].push_back(name);
    record["finished"] = finished;
    write_file(folder_ / kRunRecord,
               record.dump(2, ' ', false, Json::error_handler_t::replace) + "\n", true);
}

}  // namespace eventide
