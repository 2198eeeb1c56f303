// A source whose data are also written down, before anything behind it can lose them.
#pragma once

#include "pipeline/source.h"
#include "replay/formats.h"
#include "replay/recording_file.h"
#include "replay/written_data.h"
#include "src/io/output_file.h"

#include <memory>
#include <optional>
#include <string>

namespace eventide::app {

/// Writes on the source thread: what arrived is in the file even if the pipeline behind skips it,
/// in the format of its extension, less the kinds of data that format has no record for.
class RecordedSource : public Source {
public:
    /// `source` is borrowed; `colours` is the filter before its sensor, none where it is not known.
    /// Throws Error (usage) for an extension that is no format and for a file
    /// that exists, (failed) when it cannot be made.
    RecordedSource(Source& source, const std::string& path, ColourFilter colours,
                   OutputOptions options);
    ~RecordedSource() override;

    const SensorInfo& info() const override { return source_.info(); }
    bool is_live() const noexcept override { return source_.is_live(); }
    std::size_t packet_bytes() const override { return source_.packet_bytes(); }
    ReadStatus read(RawPacket& into) override;
    void stop() noexcept override { source_.stop(); }
    std::unique_ptr<Parser> make_parser() const override { return source_.make_parser(); }

    /// After the run: ends the file.
    void finish();
    const WrittenData& data() const { return data_; }  ///< after the run

private:
    void write(const RawPacket& packet);
    void write_batch();

    Source& source_;
    const std::string path_;
    const Format& format_;
    WrittenData data_;
    std::unique_ptr<RecordingFile> file_;
    std::unique_ptr<Parser> parser_;
    Batch batch_;
    bool told_ = false;  // that something is left out
};

}  // namespace eventide::app
