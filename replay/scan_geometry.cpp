// One pass over the events for the largest coordinates.
#include "replay/scan_geometry.h"

#include "src/core/error.h"

#include <algorithm>
#include <string>

namespace eventide {

namespace {

/// " (bad_record 3)"
std::string left_out(const Damage& damage) {
    std::string reasons;
    for (std::size_t i = 0; i < kDamageReasons; ++i)
        if (const auto n = damage[DamageReason(i)]; n > 0)
            reasons += (reasons.empty() ? "" : ", ") + std::string(name_of(DamageReason(i))) + " " +
                       std::to_string(n);
    return reasons.empty() ? "" : " (left out as damaged: " + reasons + ")";
}

}  // namespace

void scan_geometry(const ByteFile& file, OpenedStream& stream) {
    StreamHeader wide = stream.header;
    wide.width = wide.height = kLargestSensorSide;
    const auto parser = stream.make_parser(wide);
    int width = 0, height = 0;
    Batch batch;
    const auto look = [&] {
        for (const Event& event : batch.events) {
            width = std::max(width, event.x + 1);
            height = std::max(height, event.y + 1);
        }
        for (const ReferenceImage& image : batch.images) {
            width = std::max(width, image.x0 + image.pixels.width() / image.channels);
            height = std::max(height, image.y0 + image.pixels.height());
        }
        batch.clear();
    };

    std::vector<std::byte> bytes(FileRecording::kChunkBytes);
    for (std::uint64_t position = stream.header.data_offset;;) {
        const std::size_t n = file.read_at(position, bytes);
        parser->parse({bytes.data(), n}, batch);
        look();
        position += n;
        if (n < bytes.size()) break;
    }
    parser->finish(batch);
    look();
    if (width == 0)
        throw Error(ErrorKind::input,
                    file.path() + ": expected events, to find the size of the sensor, found none" +
                        left_out(parser->damaged()) + "; state it with --input-size WIDTHxHEIGHT");
    stream.header.width = width;
    stream.header.height = height;
}

}  // namespace eventide
