// The one rule about files that exist already: they are kept unless the user says otherwise.
#include "pipeline/sinks/new_file.h"

#include "src/core/error.h"

namespace eventide {

void refuse_existing(const std::filesystem::path& path, bool overwrite) {
    std::error_code none;
    const auto status = std::filesystem::status(path, none);
    if (std::filesystem::is_directory(status))
        throw Error(ErrorKind::usage, path.string() + ": expected a file, found a folder");
    if (overwrite || !std::filesystem::is_regular_file(status)) return;
    if (std::filesystem::file_size(path, none) > 0)
        throw Error(ErrorKind::usage, path.string() + ": exists already; --overwrite replaces it");
}

}  // namespace eventide
