// Where a recording goes: a file of some format, or a folder of the Event Camera Dataset.
#include "apps/cli/commands/recording_out.h"

#include <filesystem>
#include <system_error>

namespace eventide::app {

bool names_folder(const std::string& path) {
    std::error_code none;
    return path.ends_with('/') || std::filesystem::is_directory(path, none);
}

Error kept_earlier_file(const std::string& path) {
    return {ErrorKind::failed, path + ": stopped before the end; the file from before stays"};
}

RecordingOut::RecordingOut(const std::string& path, const OutputOptions& options,
                           const Format* format, StreamHeader header)
    : format_{format} {
    if (format == nullptr) {
        folder_ = std::make_unique<EcdWriter>(path, options.overwrite, header.width, header.height);
        return;
    }
    header.format = format->name;
    file_ = std::make_unique<RecordingFile>(path, options, *format, header);
}

const FormatHolds& RecordingOut::holds() const {
    static const FormatHolds of_folders{.events = true, .images = true};
    return folder_ ? of_folders : format_->holds;
}

void RecordingOut::write(const Batch& batch) {
    folder_ ? folder_->write(batch) : file_->write(batch);
}

void RecordingOut::finish() {
    folder_ ? folder_->finish() : file_->finish();
}

std::uint64_t RecordingOut::bytes_written() const {
    return folder_ ? folder_->bytes_written() : file_->bytes_written();
}

}  // namespace eventide::app
