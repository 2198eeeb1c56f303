// Small AEDAT4 files that hold some of everything, and what the parser makes of them.
#pragma once

#include "src/codec/aedat4/aedat4.h"
#include "src/codec/aedat4/aedat4_writer.h"
#include "tests/codec/parser_checks.h"

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

namespace eventide::aedat4_files {

inline constexpr int kWidth = 346, kHeight = 260;

/// Parses what follows the header, as replay does.
inline Parsed parse_file(const Bytes& file) {
    const Aedat4Header header = read_aedat4_header(file);
    const auto make = [&] {
        return std::make_unique<Aedat4Parser>(header, header.stream.width, header.stream.height);
    };
    return parse_whole(make, std::span(file).subspan(header.stream.data_offset));
}

struct File {
    Aedat4Header header;
    Bytes data;  ///< after the header
    MakeParser make() const {
        return
            [header = header] { return std::make_unique<Aedat4Parser>(header, kWidth, kHeight); };
    }
};

inline Batch some_of_everything(unsigned seed = 1) {
    Batch batch;
    batch.events = random_events(seed, 3000, kWidth, kHeight, 1'600'000'000'000'000);
    const SensorTime t = batch.events.front().t;
    for (int i = 0; i < 4; ++i) {
        const int channels = i == 2 ? 3 : i == 3 ? 4 : 1;
        ReferenceImage image{t + SensorDuration(1000 * i), {}, {}, 2, 3, channels, {}};
        image.exposure_begin = image.t - SensorDuration(i == 0 ? 0 : 50);
        image.exposure_end = image.t + SensorDuration(i == 0 ? 0 : 51);
        image.pixels = Array2<std::uint16_t>(11, 20 * channels);
        unsigned value = 0;
        for (std::uint16_t& pixel : image.pixels.values())
            pixel = std::uint16_t(i == 1 ? (value += 77) : 257 * (++value % 256));  // 16 and 8 bits
        batch.images.push_back(image);
    }
    for (int i = 0; i < 5; ++i)
        batch.imu.push_back(
            {t + SensorDuration(i), {1.5F, -2, float(i)}, {300, -1, 0}, {1, 2, 3}, 36});
    using Kind = Trigger::Kind;
    for (const Kind kind :
         {Kind::timestamp_reset, Kind::rising, Kind::falling, Kind::pulse, Kind::frame_begin,
          Kind::frame_end, Kind::exposure_begin, Kind::exposure_end})
        batch.triggers.push_back({t + SensorDuration(int(kind)), kind, 0});
    batch.triggers.push_back({t + SensorDuration(20), Kind::rising, Trigger::kGenerator});
    batch.triggers.push_back({t + SensorDuration(20), Kind::falling, Trigger::kGenerator});
    batch.triggers.push_back({t + SensorDuration(21), Kind::other, 99});
    return batch;
}

/// The first `packets` times 100 of them, a packet each.
inline std::vector<Batch> in_packets(const std::vector<Event>& events, std::size_t packets) {
    std::vector<Batch> batches(packets);
    for (std::size_t i = 0; i < packets; ++i)
        batches[i].events.assign(events.begin() + std::ptrdiff_t(100 * i),
                                 events.begin() + std::ptrdiff_t(100 * (i + 1)));
    return batches;
}

inline Bytes write_file(const std::vector<Batch>& batches, Aedat4Compression compression,
                        bool with_end = true) {
    Aedat4Writer writer(compression);
    StreamHeader header;
    header.width = kWidth;
    header.height = kHeight;
    header.sensor_name = "DAVIS346";
    header.serial = "00000104";
    Bytes out;
    writer.begin(header, out);
    for (const Batch& batch : batches) writer.write(batch, out);
    if (!with_end) return out;
    writer.finish(out);
    for (const auto& patch : writer.patches())
        std::copy(patch.bytes.begin(), patch.bytes.end(),
                  out.begin() + std::ptrdiff_t(patch.offset));
    return out;
}

inline File split_file(const Bytes& bytes) {
    File file{read_aedat4_header(bytes), {}};
    file.data.assign(bytes.begin() + std::ptrdiff_t(file.header.stream.data_offset), bytes.end());
    return file;
}

}  // namespace eventide::aedat4_files
