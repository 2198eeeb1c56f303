// Bytes of a file, a pipe or standard input, with an end to waiting.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace eventide {

/// A file opened for reading. One at a time, except stop().
class ByteFile {
public:
    /// `path` "-" is standard input. Throws Error (input) naming the path when it cannot be opened
    /// or is a directory. A pipe without writer opens at once: its first bytes are waited for.
    /// `while_waiting`, where there is one, is called every 20 ms that there are none, and may
    /// throw.
    explicit ByteFile(const std::string& path, std::function<void()> while_waiting = {});
    ~ByteFile();
    ByteFile(ByteFile&& other) noexcept;
    ByteFile(const ByteFile&) = delete;
    ByteFile& operator=(const ByteFile&) = delete;
    ByteFile& operator=(ByteFile&&) = delete;

    const std::string& path() const { return path_; }
    bool is_seekable() const { return seekable_; }  ///< false for pipes and terminals
    std::uint64_t size() const { return size_; }    ///< bytes; 0 where not seekable
    std::uint64_t position() const { return position_; }

    /// Reads what is there, at least one byte unless the end is reached or stop() was called.
    /// Returns the number of bytes, 0 at the end. `give_up`, where there is one, is asked every
    /// 20 ms that there are none: true throws Error (failed).
    std::size_t read_some(std::span<std::byte> into, const std::function<bool()>& give_up = {});

    /// Bytes at an offset, without moving position(); fewer than asked only at the end.
    std::size_t read_at(std::uint64_t offset, std::span<std::byte> into) const;

    void move_to(std::uint64_t offset) { position_ = offset; }  ///< only where is_seekable()

    void stop() noexcept { stopped_ = true; }  ///< any thread; a waiting read ends within 20 ms
    bool stopped() const noexcept { return stopped_; }

private:
    bool wait_for_bytes(const std::function<bool()>& give_up) const;

    std::string path_;
    std::function<void()> while_waiting_;
    int fd_ = -1;
    bool owned_ = false, seekable_ = false;
    std::uint64_t size_ = 0, position_ = 0;
    std::atomic<bool> stopped_{false};
};

}  // namespace eventide
