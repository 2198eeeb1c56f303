// Writing to file descriptors: pipes that wait for readers, readers that go away, signals between.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

namespace eventide {

constexpr int kStandardOutput = 1;

enum class WriteResult { written, reader_gone, failed };

/// Opens a file (made, or emptied when `overwrite`), a device, or a named pipe, for which it waits
/// until a reader opens it too, or `give_up()` says true: then -1. Throws Error (usage) for an
/// existing file without `overwrite`, (failed) when it cannot be opened.
int open_for_writing(const std::string& path, bool overwrite, const std::function<bool()>& give_up);

/// Writes everything, however often the system takes only a part.
WriteResult write_all(int file, std::span<const std::byte> bytes);

void close_descriptor(int file);

/// The words for errno, right after a failure.
std::string last_system_error();

}  // namespace eventide
