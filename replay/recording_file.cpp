// Bytes of a StreamWriter into a file.
#include "replay/recording_file.h"

#include "src/core/error.h"

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace eventide {

namespace {

[[noreturn]] void fail(const std::string& path) {
    throw Error(ErrorKind::failed,
                path + ": cannot write: " + std::system_category().message(errno));
}

}  // namespace

RecordingFile::RecordingFile(const std::string& path, bool overwrite,
                             std::unique_ptr<StreamWriter> writer, const StreamHeader& header)
    : path_(path == "-" ? "standard output" : path), writer_(std::move(writer)) {
    owned_ = path != "-";
    writer_->begin(header, pending_);  // before the file is made: it may refuse the header
    // "x": made new or not at all, also when another makes it at the same moment. Pipes and devices
    // are there already, and not overwritten.
    std::error_code none;
    const bool is_other = std::filesystem::is_other(path, none);
    file_ = owned_ ? std::fopen(path.c_str(), overwrite || is_other ? "wb" : "wbx") : stdout;
    if (!file_ && errno == EEXIST)
        throw Error(ErrorKind::usage, path_ +
                                          ": expected a new file, found one that exists; "
                                          "--overwrite replaces it");
    if (!file_) fail(path_);
}

RecordingFile::~RecordingFile() {
    if (file_ && owned_) std::fclose(file_);
}

void RecordingFile::put(std::span<const std::byte> bytes) {
    if (reader_gone_ || std::fwrite(bytes.data(), 1, bytes.size(), file_) == bytes.size()) return;
    if (errno != EPIPE) fail(path_);
    reader_gone_ = true;
}

void RecordingFile::flush() {
    put(pending_);
    bytes_written_ += pending_.size();
    pending_.clear();
}

void RecordingFile::write(const Batch& batch) {
    writer_->write(batch, pending_);
    flush();
}

void RecordingFile::finish() {
    writer_->finish(pending_);
    flush();
    for (const StreamWriter::Patch& patch : writer_->patches()) {
        if (std::fseek(file_, long(patch.offset), SEEK_SET) != 0) {
            if (errno == ESPIPE) break;  // the index stays unnamed, as after a crash
            fail(path_);
        }
        put(patch.bytes);
    }
    std::FILE* file = std::exchange(file_, nullptr);
    if ((owned_ ? std::fclose(file) : std::fflush(file)) == 0 || reader_gone_) return;
    if (errno != EPIPE) fail(path_);
    reader_gone_ = true;
}

}  // namespace eventide
