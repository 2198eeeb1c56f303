// A source whose data are also written down.
#include "apps/cli/run/recorded_source.h"

#include "src/core/error.h"

namespace eventide::app {

RecordedSource::RecordedSource(Source& source, const std::string& path, OutputOptions options)
    : source_{source} {
    options.appears = Appears::growing;
    if (path.ends_with(".bin")) {
        bytes_.emplace(path, options);
        return;
    }
    format_ = format_for_writing(path);
    if (format_ == nullptr)
        throw Error(ErrorKind::usage, "--record " + path +
                                          ": expected the extension of a format that can be "
                                          "written (.aedat4, .raw, .txt, ...) or .bin");
    StreamHeader header;
    header.format = format_->name;
    header.width = source.info().width;
    header.height = source.info().height;
    header.sensor_name = source.info().name;
    header.serial = source.info().serial;
    header.colour_filter = source.info().colour_filter;
    file_ = std::make_unique<RecordingFile>(path, options, *format_, header);
    parser_ = source.make_parser();
    times_.emplace(format_->holds);
}

RecordedSource::~RecordedSource() = default;

ReadStatus RecordedSource::read(RawPacket& into) {
    const ReadStatus status = source_.read(into);
    if (status == ReadStatus::data) write(into);
    return status;
}

void RecordedSource::write(const RawPacket& packet) {
    if (bytes_) return bytes_->write(packet.bytes);
    // As the pipeline's own parser does it, so that both tell the same times.
    if (packet.gap_before) packet.reopened ? parser_->reopened() : parser_->resync();
    if (is_live()) parser_->arrives(packet.arrived);
    parser_->parse(packet.bytes, batch_);
    write_batch();
}

void RecordedSource::write_batch() {
    remove_not_held(batch_, format_->holds);
    times_->put_in_order(batch_);
    if (!batch_.empty()) file_->write(batch_);
    batch_.clear();
}

void RecordedSource::finish() {
    if (bytes_) return bytes_->close();
    parser_->finish(batch_);
    write_batch();
    file_->finish();
}

}  // namespace eventide::app
