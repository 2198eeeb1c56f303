// AEDAT 3 packets, spelled out, and some of everything.
#pragma once

#include "src/codec/aedat/aedat3.h"
#include "src/core/byte_order.h"
#include "tests/codec/parser_checks.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace eventide::aedat3 {

constexpr int kWidth = 346, kHeight = 260;

inline MakeParser make_parser(bool lower_left = false, std::optional<int> source = 1) {
    return [=] {
        Aedat3Header header;
        header.lower_left = lower_left;
        header.source = source;
        return std::make_unique<Aedat3Parser>(header, kWidth, kHeight);
    };
}

/// The 28 bytes, field by field.
inline Bytes packet_header(int type, std::uint32_t record_bytes, std::uint32_t number,
                           std::uint32_t overflow = 0, int source = 1) {
    Bytes out;
    append_little(out, std::int16_t(type));
    append_little(out, std::int16_t(source));
    append_little(out, record_bytes);
    append_little(out, std::uint32_t(type == 2 ? 8 : 4));
    append_little(out, overflow);
    append_little(out, number);
    append_little(out, number);
    append_little(out, number);
    return out;
}

inline Bytes words(const std::vector<std::uint32_t>& values) {
    Bytes out;
    for (const std::uint32_t value : values) append_little(out, value);
    return out;
}

inline Bytes operator+(Bytes a, const Bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

inline std::uint32_t polarity(int x, int y, bool on, bool valid = true) {
    return std::uint32_t(x) << 17 | std::uint32_t(y) << 2 | std::uint32_t(on) << 1 |
           std::uint32_t(valid);
}
inline std::uint32_t special(int type) {
    return 1U | std::uint32_t(type) << 1;
}

inline Batch everything(unsigned seed, std::int64_t first_us) {
    Batch batch;
    batch.events = random_events(seed, 400, kWidth, kHeight, first_us);
    std::mt19937 random(seed);
    const auto time = [&](int i) { return from_us(first_us + 1000 * i); };
    for (int i = 0; i < 3; ++i) {
        ReferenceImage image;
        image.exposure_begin = time(i);
        image.exposure_end = time(i) + SensorDuration(500);
        image.t = time(i) + SensorDuration(250);
        image.x0 = i;
        image.y0 = 2 * i;
        image.channels = i == 0 ? 1 : i + 2;
        image.pixels = Array2<std::uint16_t>(3 + i, 5 * image.channels);
        for (auto& value : image.pixels.values()) value = std::uint16_t(random());
        batch.images.push_back(image);
    }
    for (int i = 0; i < 6; ++i) {
        ImuSample sample;
        sample.t = time(i);
        for (std::size_t k = 0; k < 3; ++k) {
            sample.acceleration_g[k] = float(random() % 1000) / 7;
            sample.gyro_dps[k] = -float(random() % 1000) / 3;
            if (i >= 4) sample.magnetic_ut[k] = float(k + 1);
        }
        sample.temperature_c = 31.5F;
        batch.imu.push_back(sample);
    }
    for (int kind = 0; kind <= int(Trigger::Kind::other); ++kind)
        for (const int source : {0, 1, 2, 3, 9, 255})
            batch.triggers.push_back({time(kind), Trigger::Kind(kind), std::uint8_t(source)});
    return batch;
}

inline Bytes written(std::size_t events) {
    Bytes bytes;
    Batch batch = everything(5, 1'000'000);
    batch.events = random_events(5, events, kWidth, kHeight, 1'000'000);
    Aedat3Writer writer;
    writer.write(batch, bytes);
    batch.events = random_events(6, events, kWidth, kHeight, 1'100'000);
    writer.write(batch, bytes);
    return bytes;
}

}  // namespace eventide::aedat3
