// A file being written: the bytes of a StreamWriter, and its patches at the end.
#pragma once

#include "src/codec/stream.h"

#include <cstdio>
#include <memory>
#include <span>
#include <string>

namespace eventide {

/// Writes a recording; complete only after finish(). "-" is standard output. In pipes patches are
/// left out: formats with an index are read without it.
class RecordingFile {
public:
    /// Throws Error (usage) when a regular file exists and `overwrite` is false, Error (failed)
    /// when it cannot be made.
    RecordingFile(const std::string& path, bool overwrite, std::unique_ptr<StreamWriter> writer,
                  const StreamHeader& header);
    ~RecordingFile();
    RecordingFile(const RecordingFile&) = delete;
    RecordingFile& operator=(const RecordingFile&) = delete;

    /// Throws Error (failed) when the disk is full, Error (usage) for what the format cannot hold.
    void write(const Batch& batch);

    /// Ends the stream, applies the patches, closes. Throws like write().
    void finish();

    std::uint64_t bytes_written() const { return bytes_written_; }

    /// Whoever read the pipe went away: no error, but nothing is written any more.
    bool reader_gone() const { return reader_gone_; }

private:
    void put(std::span<const std::byte> bytes);
    void flush();

    std::string path_;
    std::unique_ptr<StreamWriter> writer_;
    std::FILE* file_ = nullptr;
    bool owned_ = false;
    std::vector<std::byte> pending_;
    std::uint64_t bytes_written_ = 0;
    bool reader_gone_ = false;
};

}  // namespace eventide
