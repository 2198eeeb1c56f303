// What readers of files are fuzzed with: a file in memory, under a path that any of them can open.
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

namespace eventide {

class MemoryFile {
public:
    MemoryFile() : fd_(::open(path_.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600)) {
        if (fd_ < 0) std::abort();
    }
    ~MemoryFile() {
        ::close(fd_);
        ::unlink(path_.c_str());
    }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    void hold(std::string_view bytes) {
        if (::ftruncate(fd_, 0) != 0 ||
            ::pwrite(fd_, bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
            std::abort();
    }
    void hold(const std::uint8_t* data, std::size_t size) {
        hold({reinterpret_cast<const char*>(data), size});
    }
    const std::string& path() const { return path_; }

private:
    /// With a name: HDF5 takes no file without one.
    std::string path_ = "/dev/shm/eventide_fuzz_file_" + std::to_string(::getpid());
    int fd_;
};

inline std::string_view text_of_input(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

/// Takes what stands before the first `end` off the front of `rest`; all of it where there is none.
inline std::string_view take_until(std::string_view& rest, char end) {
    const std::size_t at = rest.find(end);
    const std::string_view front = rest.substr(0, at);
    rest.remove_prefix(at == std::string_view::npos ? rest.size() : at + 1);
    return front;
}

}  // namespace eventide
