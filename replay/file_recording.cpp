// Chunks out of a file, and the way to a time in it.
#include "replay/file_recording.h"

#include "replay/seek.h"

#include <utility>

namespace eventide {

FileRecording::FileRecording(ByteFile file, OpenedStream stream, std::vector<std::byte> ahead)
    : file_(std::move(file)), stream_(std::move(stream)), ahead_(std::move(ahead)) {
    const StreamHeader& header = stream_.header;
    info_ = {header.sensor_name, header.serial, header.format, header.width, header.height};
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
    return stream_.make_parser(stream_.header);
}

void FileRecording::seek(SensorTime t) {
    if (!file_.is_seekable()) return;
    const std::uint64_t position = find_position(file_, stream_, t);
    file_.move_to(position);
    ahead_.clear();
    // The first line follows no newline that a parser looking for one could find.
    if (stream_.records_are_lines && position == stream_.header.data_offset)
        ahead_ = {std::byte{'\n'}};
}

}  // namespace eventide
