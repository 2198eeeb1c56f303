// Opening a file to read it.
#include "src/io/input_file.h"

#include "src/io/system_words.h"

#include <cerrno>

namespace eventide {

std::ifstream open_to_read(const std::filesystem::path& path, ErrorKind kind) {
    std::error_code none;
    if (std::filesystem::is_directory(path, none))
        throw Error(kind, path.string() + ": expected a file, found a folder");
    errno = 0;
    std::ifstream stream{path, std::ios::binary};
    if (stream) return stream;
    const int error = errno;
    const bool exhausted = error == EMFILE || error == ENFILE;
    throw Error(exhausted ? ErrorKind::failed : kind,
                path.string() + ": cannot be read: " + system_words(error));
}

}  // namespace eventide
