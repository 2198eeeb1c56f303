// Chunks out of a file, and the way to a time in it.
#include "replay/stream/file_recording.h"

#include <algorithm>
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

/// Of a small file no more than it has: a chunk's bytes are cleared before they are read. Something
/// more is asked for at its end, as it may still grow.
std::size_t FileRecording::next_chunk_bytes() const {
    constexpr std::uint64_t kLeast = 4096;
    if (!file_.is_seekable()) return kChunkBytes;
    const std::uint64_t left = file_.size() - std::min(file_.position(), file_.size());
    return std::size_t(std::clamp<std::uint64_t>(left, kLeast, kChunkBytes));
}

ReadStatus FileRecording::read(RawPacket& into) {
    into.gap_before = false;
    if (!ahead_.empty() && !file_.stopped()) {
        into.bytes = std::exchange(ahead_, {});
    } else {
        into.bytes.resize(next_chunk_bytes());
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
