// A source whose data are also written down.
#include "apps/cli/run/recorded_source.h"

#include "replay/convert.h"
#include "src/core/error.h"

#include <spdlog/spdlog.h>

#include <utility>

namespace eventide::app {
namespace {

const Format& format_of(const std::string& path) {
    const Format* const format = format_for_writing(path);
    if (format == nullptr)
        throw Error(ErrorKind::usage, "--record " + path +
                                          ": expected the extension of a format that can be "
                                          "written (.aedat4, .raw, .txt, ...)");
    return *format;
}

}  // namespace

RecordedSource::RecordedSource(Source& source, const std::string& path, ColourFilter colours,
                               OutputOptions options)
    : source_{source}, path_{path}, format_{format_of(path)}, data_{format_.holds, colours} {
    options.appears = Appears::growing;
    StreamHeader header = header_of(source.info());
    header.format = format_.name;
    header.colour_filter = colours;
    file_ = std::make_unique<RecordingFile>(path, options, format_, header);
    parser_ = source.make_parser();
}

RecordedSource::~RecordedSource() = default;

ReadStatus RecordedSource::read(RawPacket& into) {
    const ReadStatus status = source_.read(into);
    if (status == ReadStatus::data) write(into);
    return status;
}

void RecordedSource::write(const RawPacket& packet) {
    parse_packet(packet, is_live(), *parser_, batch_);
    write_batch();
}

void RecordedSource::write_batch() {
    data_.fit(batch_);
    if (data_.left_out() != DataCounts{} && !std::exchange(told_, true))
        spdlog::warn("--record {}: {} cannot hold all that comes: {} so far (.aedat4 can)", path_,
                     format_.title, text_of(data_.left_out()));
    if (!batch_.empty()) file_->write(batch_);
    batch_.clear();
}

void RecordedSource::finish() {
    parser_->finish(batch_);
    write_batch();
    file_->finish();
}

}  // namespace eventide::app
