// Where a recording goes: a file of some format, or a folder of the Event Camera Dataset.
#pragma once

#include "apps/cli/commands/ecd_writer.h"
#include "replay/convert.h"
#include "replay/formats.h"
#include "replay/recording_file.h"
#include "src/core/error.h"

#include <memory>
#include <string>

namespace eventide::app {

/// "folder/", or what is a folder already.
bool names_folder(const std::string& path);

/// What to throw where a recording was stopped before its end, and would have replaced an earlier
/// file.
Error kept_earlier_file(const std::string& path);

class RecordingOut final : public ConvertTarget {
public:
    /// `format` is empty for a folder, and `path` then that of one. `header` says whose data they
    /// are; its format is filled in. Throws Error as RecordingFile and EcdWriter do.
    RecordingOut(const std::string& path, const OutputOptions& options, const Format* format,
                 StreamHeader header);

    const FormatHolds& holds() const override;
    void write(const Batch& batch) override;
    void finish() override;
    PipeReader reader() const override { return file_ ? file_->reader() : PipeReader::takes; }
    std::uint64_t bytes_written() const override;

private:
    const Format* format_;
    std::unique_ptr<EcdWriter> folder_;    // either this ...
    std::unique_ptr<RecordingFile> file_;  // ... or this
};

}  // namespace eventide::app
