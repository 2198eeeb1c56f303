// Opening a file to read it, and reading all of it.
#include "src/io/input_file.h"

#include "src/io/system_words.h"

#include <array>
#include <cerrno>

namespace eventide {

std::ifstream open_to_read(const std::filesystem::path& path, ErrorKind kind) {
    if (path.empty()) throw Error(kind, "expected the name of a file, found ''");
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

std::string read_text_file(const std::filesystem::path& path, ErrorKind kind,
                           std::size_t most_bytes) {
    std::ifstream stream = open_to_read(path, kind);
    std::string text;
    std::array<char, 4096> part;
    while (stream && text.size() <= most_bytes) {
        stream.read(part.data(), part.size());
        text.append(part.data(), std::size_t(stream.gcount()));
    }
    if (text.size() > most_bytes)
        throw Error(kind, path.string() + ": expected at most " + std::to_string(most_bytes >> 20) +
                              " MiB of text, found more");
    return text;
}

std::vector<std::byte> read_bytes_of_file(const std::filesystem::path& path) {
    std::ifstream stream = open_to_read(path);
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        throw Error(ErrorKind::input,
                    path.string() + ": expected a file, found a pipe or a device");
    std::vector<std::byte> bytes(std::filesystem::file_size(path));
    stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
    if (std::size_t(stream.gcount()) != bytes.size())
        throw Error(ErrorKind::input, path.string() + ": cannot be read");
    return bytes;
}

}  // namespace eventide
