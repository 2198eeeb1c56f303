// Parts of a file as packets of plain records.
#include "replay/data_recording.h"

#include "src/codec/plain_records.h"

#include <algorithm>
#include <utility>

namespace eventide {

DataRecording::DataRecording(std::unique_ptr<DataReader> reader, std::uint64_t bytes)
    : reader_(std::move(reader)), bytes_(bytes) {
    const StreamHeader& header = reader_->header();
    info_ = {header.sensor_name, header.serial, header.format,
             header.width,       header.height, header.colour_filter};
    note_position();
}

ReadStatus DataRecording::read(RawPacket& into) {
    into.gap_before = false;
    into.bytes.clear();
    for (bool more = true; more && into.bytes.empty() && !stopped_;) {
        Damage damage;
        batch_.clear();
        more = reader_->read(batch_, damage);
        append_plain_records(batch_, damage, into.bytes);
    }
    note_position();
    into.arrived = std::chrono::steady_clock::now();
    if (stopped_) into.bytes.clear();
    if (into.bytes.empty()) return ReadStatus::end;
    into.sequence = packets_++;
    return ReadStatus::data;
}

std::unique_ptr<Parser> DataRecording::make_parser() const {
    return std::make_unique<PlainRecordsParser>(info_.width, info_.height);
}

void DataRecording::seek(SensorTime t) {
    reader_->seek(t);
    note_position();
}

void DataRecording::note_position() {
    position_ = std::uint64_t(std::clamp(reader_->progress(), 0.0, 1.0) * double(bytes_));
}

}  // namespace eventide
