// Bytes of a StreamWriter into a file.
#include "replay/recording_file.h"

#include <utility>

namespace eventide {

RecordingFile::RecordingFile(const std::string& path, bool overwrite,
                             std::unique_ptr<StreamWriter> writer, const StreamHeader& header,
                             Appears appears)
    : writer_(std::move(writer)) {
    writer_->begin(header, pending_);  // before the file is made: it may refuse the header
    file_.emplace(path, OutputOptions{.overwrite = overwrite, .appears = appears});
}

RecordingFile::RecordingFile(const std::string& path, const OutputOptions& options,
                             const Format& format, const StreamHeader& header) {
    if (format.make_file_writer == nullptr) {
        writer_ = open_writer(format.name);
        writer_->begin(header, pending_);
        file_.emplace(path, options);
        return;
    }
    file_.emplace(path, options);
    file_writer_ = format.make_file_writer(*file_, header);
}

void RecordingFile::flush() {
    file_->write(pending_);
    bytes_written_ += pending_.size();
    pending_.clear();
}

void RecordingFile::write(const Batch& batch) {
    if (file_writer_) return file_writer_->write(batch);
    writer_->write(batch, pending_);
    flush();
}

void RecordingFile::finish() {
    if (file_writer_) {
        file_writer_->finish();
        bytes_written_ = file_->size();
        return file_->close();
    }
    writer_->finish(pending_);
    flush();
    // Elsewhere the index stays unnamed, as after a crash.
    if (file_->is_seekable())
        for (const StreamWriter::Patch& patch : writer_->patches())
            file_->write_at(patch.offset, patch.bytes);
    file_->close();
}

}  // namespace eventide
