// What a fuzzer asks of a whole recording in one format: orderly data, the same after going back.
#pragma once

#include "replay/formats.h"
#include "src/core/error.h"
#include "tests/fuzz/codec/fuzz_parser.h"
#include "tests/fuzz/fuzz_file.h"

#include <cstdint>
#include <string>
#include <utility>

namespace eventide {

struct RecordedForFuzzer {
    Batch data;
    Damage damage;
};

/// From where the recording stands.
inline RecordedForFuzzer read_for_fuzzer(Recording& recording) {
    RecordedForFuzzer read;
    const auto parser = recording.make_parser();
    RawPacket packet;
    while (recording.read(packet) == ReadStatus::data) parser->parse(packet.bytes, read.data);
    parser->finish(read.data);
    read.damage = parser->damaged();
    return read;
}

/// Going back may tell that an index does not fit.
inline std::uint64_t without_tables(const Damage& damage) {
    return damage.total() - damage[DamageReason::bad_table];
}

/// The file as a recording of that format, whatever it begins with.
inline void fuzz_recording_at(const std::string& path, const std::string& format) {
    try {
        OpenOptions options;
        options.format = format;
        const auto recording = open_recording(path, options);
        const auto [width, height] = std::pair{recording->info().width, recording->info().height};
        const RecordedForFuzzer all = read_for_fuzzer(*recording);
        require_order(all.data);
        for (const Event& event : all.data.events) require(event.x < width && event.y < height);
        recording->seek(SensorTime::min());
        const RecordedForFuzzer again = read_for_fuzzer(*recording);
        require(again.data.events == all.data.events);
        require(again.data.images == all.data.images);
        require(without_tables(again.damage) == without_tables(all.damage));
        if (all.data.events.empty()) return;
        recording->seek(all.data.events[all.data.events.size() / 2].t);
        require_order(read_for_fuzzer(*recording).data);
    } catch (const Error&) {
    }
}

/// Any bytes as a file of that format.
inline void fuzz_recording_as(const std::string& format, const std::uint8_t* data,
                              std::size_t size) {
    static MemoryFile file;
    file.hold(data, size);
    fuzz_recording_at(file.path(), format);
}

}  // namespace eventide
