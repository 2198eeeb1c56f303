// What may be made or replaced under a name.
#include "src/io/output_paths.h"

#include "src/core/number_text.h"
#include "src/io/system_words.h"

#include <unistd.h>

#include <string>
#include <system_error>

namespace eventide {

namespace fs = std::filesystem;

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

bool is_standard_output(const fs::path& path) {
    return descriptor_named(path) == STDOUT_FILENO;
}

bool create_folder(const fs::path& path) {
    std::error_code error;
    const bool created = fs::create_directories(path, error);
    if (error)
        throw Error(ErrorKind::failed,
                    path.string() + ": cannot be created: " + system_words(error.value()));
    return created;
}

}  // namespace eventide
