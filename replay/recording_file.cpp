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

void RecordingFile::flush() {
    if (std::fwrite(pending_.data(), 1, pending_.size(), file_) != pending_.size()) fail(path_);
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
        if (std::fwrite(patch.bytes.data(), 1, patch.bytes.size(), file_) != patch.bytes.size())
            fail(path_);
    }
    std::FILE* file = std::exchange(file_, nullptr);
    if ((owned_ ? std::fclose(file) : std::fflush(file)) != 0) fail(path_);
}

}  // namespace eventide
