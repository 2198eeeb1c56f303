// A file being written: the bytes of a StreamWriter, and its patches at the end.
#pragma once

#include "replay/formats.h"
#include "src/codec/stream.h"
#include "src/io/output_file.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace eventide {

/// Writes a recording; complete only after finish(). "-" is standard output. In pipes patches are
/// left out: formats with an index are read without it.
class RecordingFile {
public:
    /// Throws Error as OutputFile does.
    RecordingFile(const std::string& path, bool overwrite, std::unique_ptr<StreamWriter> writer,
                  const StreamHeader& header, Appears appears = Appears::whole);

    /// In a format of the table, also one that is no stream of bytes (then `path` is no pipe).
    RecordingFile(const std::string& path, const OutputOptions& options, const Format& format,
                  const StreamHeader& header);

    /// Throws Error (failed) when the disk is full, Error (usage) for what the format cannot hold.
    void write(const Batch& batch);

    /// Ends the stream, applies the patches, closes. Throws like write().
    void finish();

    std::uint64_t bytes_written() const { return bytes_written_; }

    /// As OutputFile::reader().
    PipeReader reader() const { return file_->reader(); }

private:
    void flush();

    std::unique_ptr<StreamWriter> writer_;  // either this ...
    std::optional<OutputFile> file_;
    std::unique_ptr<FileWriter> file_writer_;  // ... or this
    std::vector<std::byte> pending_;
    std::uint64_t bytes_written_ = 0;
};

}  // namespace eventide
