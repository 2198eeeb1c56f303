// Chunks out of a file, and the way to a time in it.
#include "replay/stream/file_recording.h"

#include <utility>

namespace eventide {

FileRecording::FileRecording(ByteFile file, OpenedStream stream, std::vector<std::byte> ahead)
    : file_(std::move(file)), stream_(std::move(stream)), ahead_(std::move(ahead)) {
    const StreamHeader& header = stream_.header;
    info_ = {header.sensor_name, header.serial, header.format,
             header.width,       header.height, header.colour_filter};
    begin_.position = header.data_offset;
    if (file_.is_seekable()) file_.move_to(header.data_offset);
}

ReadStatus FileRecording::read(RawPacket& into) {
    into.gap_before = false;
    if (!ahead_.empty() && !file_.stopped()) {
        into.bytes = std::exchange(ahead_, {});
    } else {
        into.bytes.resize(kChunkBytes);
        into.bytes.resize(file_.read_some(into.bytes));
    }
    into.arrived = std::chrono::steady_clock::now();
    if (into.bytes.empty() || file_.stopped()) {
        into.bytes.clear();
        return ReadStatus::end;
    }
    into.sequence = packets_++;
    return ReadStatus::data;
}

std::unique_ptr<Parser> FileRecording::make_parser() const {
    if (begin_.parser) return stream_.seek.copy(*begin_.parser);
    auto parser = stream_.make_parser(stream_.header);
    if (begins_in_the_middle()) parser->resync();
    return parser;
}

void FileRecording::seek(SensorTime t) {
    if (!file_.is_seekable()) return;
    begin_ = find_seek_point(file_, stream_.header, stream_.make_parser, stream_.seek, t);
    file_.move_to(begin_.position);
    ahead_.clear();
}

}  // namespace eventide
