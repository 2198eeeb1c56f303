// Events, frames, IMU samples, triggers -> AEDAT 3.1 packets.
#include "src/codec/aedat/aedat3.h"
#include "src/codec/aedat/aedat3_records.h"
#include "src/codec/append_text.h"
#include "src/codec/batch_parts.h"
#include "src/core/byte_order.h"
#include "src/core/error.h"

#include <algorithm>
#include <string>

namespace eventide {

namespace {

constexpr int kSource = 1;
constexpr std::uint32_t kTimeOffset = 4, kFrameTimeOffset = 8;  // a frame's is its end

std::uint32_t overflow_of(SensorTime t) {
    if (to_us(t) < 0 || to_us(t) >> 31 > 1 << 22)
        throw Error(ErrorKind::usage, "AEDAT 3.1: expected times from 0 to 2^53 us, found " +
                                          std::to_string(to_us(t)) + " us");
    return std::uint32_t(to_us(t) >> 31);
}

std::uint32_t stamp_of(SensorTime t) {
    return std::uint32_t(to_us(t) & 0x7FFFFFFF);
}

void append_header(Aedat3Type type, std::uint32_t record_bytes, std::uint32_t overflow,
                   std::size_t number, std::vector<std::byte>& out) {
    append_little(out, std::int16_t(type));
    append_little(out, std::int16_t(kSource));
    append_little(out, record_bytes);
    append_little(out, type == Aedat3Type::frame ? kFrameTimeOffset : kTimeOffset);
    append_little(out, overflow);
    for (int i = 0; i < 3; ++i) append_little(out, std::uint32_t(number));  // all of them valid
}

/// The items as packets, each of one overflow and at most kPacketRecords.
template <typename T, typename Append>
void append_packets(Aedat3Type type, std::uint32_t record_bytes, std::span<const T> items,
                    std::vector<std::byte>& out, Append&& append_record) {
    for (std::size_t begin = 0; begin < items.size();) {
        const std::uint32_t overflow = overflow_of(items[begin].t);
        std::size_t end = begin;
        while (end < items.size() && end - begin < Aedat3Writer::kPacketRecords &&
               overflow_of(items[end].t) == overflow)
            ++end;
        append_header(type, record_bytes, overflow, end - begin, out);
        for (; begin < end; ++begin) append_record(items[begin]);
    }
}

void append_event(const Event& event, std::vector<std::byte>& out) {
    constexpr std::uint16_t kMax = 0x7FFF;
    if (event.x > kMax || event.y > kMax)
        throw Error(ErrorKind::usage, "AEDAT 3.1: expected coordinates up to 32767, found (" +
                                          std::to_string(event.x) + ", " + std::to_string(event.y) +
                                          ")");
    append_little(out, 1U | std::uint32_t(event.polarity == Polarity::on) << 1 |
                           std::uint32_t(event.y) << 2 | std::uint32_t(event.x) << 17);
    append_little(out, stamp_of(event.t));
}

void append_image(const ReferenceImage& image, ColourFilter of_sensor,
                  std::vector<std::byte>& out) {
    const std::size_t bytes = Aedat3Packet::kFrameHeaderBytes + 2 * image.pixels.values().size();
    if (image.x0 < 0 || image.y0 < 0)
        throw Error(ErrorKind::usage,
                    "AEDAT 3.1: expected a frame within the sensor, found one at " +
                        std::to_string(image.x0) + ", " + std::to_string(image.y0));
    if (image.pixels.empty() || bytes > Aedat3Packet::kMaxFrameBytes)
        throw Error(ErrorKind::usage, "AEDAT 3.1: expected a frame of 1 to 2048 x 2048 px, found " +
                                          std::to_string(image.pixels.width()) + "x" +
                                          std::to_string(image.pixels.height()));
    const std::uint32_t overflow = overflow_of(image.exposure_begin);
    append_header(Aedat3Type::frame, std::uint32_t(bytes), overflow, 1, out);
    const bool says = image.channels != 1 || image.filter != ColourFilter::none;
    write_frame(image, says ? image.filter : of_sensor, std::int64_t(overflow) << 31, out);
}

bool has_magnetometer(const ImuSample& sample) {
    return sample.magnetic_ut != std::array<float, 3>{};
}

/// Runs of samples with and without a magnetometer, each in packets of its type.
void append_imu(std::span<const ImuSample> samples, std::vector<std::byte>& out) {
    while (!samples.empty()) {
        const bool nine = has_magnetometer(samples.front());
        const auto end = std::ranges::find_if(
            samples, [&](const ImuSample& sample) { return has_magnetometer(sample) != nine; });
        const auto n = std::size_t(end - samples.begin());
        append_packets(
            nine ? Aedat3Type::imu9 : Aedat3Type::imu6,
            nine ? Aedat3Packet::kImu9Bytes : Aedat3Packet::kImu6Bytes, samples.first(n), out,
            [&](const ImuSample& sample) { write_imu(sample, nine, stamp_of(sample.t), out); });
        samples = samples.subspan(n);
    }
}

}  // namespace

void Aedat3Writer::begin(const StreamHeader& header, std::vector<std::byte>& out) {
    colours_ = header.colour_filter;
    const std::string name = header.sensor_name.empty() ? "unknown" : header.sensor_name;
    append_text(out, "#!AER-DAT3.1\r\n#Format: RAW\r\n#Source " + std::to_string(kSource) + ": " +
                         name + "\r\n");
    if (header.width > 0 && header.height > 0)
        append_text(out, "#Geometry: " + std::to_string(header.width) + "x" +
                             std::to_string(header.height) + "\r\n");
    append_text(out, "#!END-HEADER\r\n");
}

void Aedat3Writer::write(const Batch& batch, std::vector<std::byte>& out) {
    out.reserve(out.size() + Aedat3Packet::kPolarityBytes * batch.events.size());
    in_parts(batch, [&](const BatchPart& part) {
        // First: that the clock began anew comes before the events that it is true of.
        append_packets(Aedat3Type::special, Aedat3Packet::kSpecialBytes, part.triggers, out,
                       [&](const Trigger& trigger) {
                           append_little(out, write_special(trigger));
                           append_little(out, stamp_of(trigger.t));
                       });
        append_packets(Aedat3Type::polarity, Aedat3Packet::kPolarityBytes, part.events, out,
                       [&](const Event& event) { append_event(event, out); });
        for (const ReferenceImage& image : part.images) append_image(image, colours_, out);
        append_imu(part.imu, out);
    });
}

}  // namespace eventide
