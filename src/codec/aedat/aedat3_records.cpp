// Frames, IMU samples and special events of AEDAT 3.
#include "src/codec/aedat/aedat3_records.h"

#include "src/codec/aedat/aedat3_packet.h"
#include "src/core/bayer.h"
#include "src/core/byte_order.h"

#include <array>

namespace eventide {

namespace {

struct SpecialMeaning {
    Aedat3Special number;
    Trigger::Kind kind;
    std::uint8_t source;
};
using Kind = Trigger::Kind;
constexpr std::array kMeanings{
    SpecialMeaning{Aedat3Special::timestamp_reset, Kind::timestamp_reset, 0},
    SpecialMeaning{Aedat3Special::rising, Kind::rising, 0},
    SpecialMeaning{Aedat3Special::falling, Kind::falling, 0},
    SpecialMeaning{Aedat3Special::pulse, Kind::pulse, 0},
    SpecialMeaning{Aedat3Special::rising_1, Kind::rising, 1},
    SpecialMeaning{Aedat3Special::falling_1, Kind::falling, 1},
    SpecialMeaning{Aedat3Special::pulse_1, Kind::pulse, 1},
    SpecialMeaning{Aedat3Special::rising_2, Kind::rising, 2},
    SpecialMeaning{Aedat3Special::falling_2, Kind::falling, 2},
    SpecialMeaning{Aedat3Special::pulse_2, Kind::pulse, 2},
    SpecialMeaning{Aedat3Special::generator_rising, Kind::rising, Trigger::kGenerator},
    SpecialMeaning{Aedat3Special::generator_falling, Kind::falling, Trigger::kGenerator},
    SpecialMeaning{Aedat3Special::frame_begin, Kind::frame_begin, 0},
    SpecialMeaning{Aedat3Special::frame_end, Kind::frame_end, 0},
    SpecialMeaning{Aedat3Special::exposure_begin, Kind::exposure_begin, 0},
    SpecialMeaning{Aedat3Special::exposure_end, Kind::exposure_end, 0},
    SpecialMeaning{Aedat3Special::other, Kind::other, 0},
};

std::uint32_t special_word(Aedat3Special number, std::uint32_t data) {
    return 1U | std::uint32_t(number) << 1 | data << 8;
}

/// Stamps of frames count on beyond 2^31 where an exposure crosses an overflow.
SensorTime time_at(const std::byte* p, std::int64_t base_us) {
    return from_us(base_us + std::int64_t(load_little<std::uint32_t>(p)));
}

/// AEDAT 3 orders colours red, green, blue; ReferenceImage blue, green, red.
std::size_t swapped_channel(std::size_t i, int channels) {
    const std::size_t channel = i % std::size_t(channels);
    if (channels < 3 || channel > 2) return i;
    return i + 2 - 2 * channel;
}

}  // namespace

std::optional<Trigger> read_special(std::uint32_t word) {
    const auto number = Aedat3Special((word >> 1) & 0x7F);
    if (number == Aedat3Special::timestamp_wrap || number == Aedat3Special::row_only) return {};
    const auto data = std::uint8_t(word >> 8);
    for (const SpecialMeaning& meaning : kMeanings)
        if (meaning.number == number)
            return Trigger{{},
                           meaning.kind,
                           meaning.source == Trigger::kGenerator
                               ? meaning.source
                               : std::uint8_t(meaning.source + data)};
    return Trigger{{}, Kind::other, data};
}

/// The number that says kind and input; inputs without one have the kind's first, and the data
/// field (which the format leaves at zero) says how far on they are.
std::uint32_t write_special(const Trigger& trigger) {
    for (const SpecialMeaning& meaning : kMeanings)
        if (meaning.kind == trigger.kind && meaning.source == trigger.source)
            return special_word(meaning.number, 0);
    for (const SpecialMeaning& meaning : kMeanings)
        if (meaning.kind == trigger.kind) return special_word(meaning.number, trigger.source);
    return special_word(Aedat3Special::other, trigger.source);
}

ImuSample read_imu(std::span<const std::byte> record, std::int64_t base_us) {
    ImuSample sample;
    sample.t = from_us(base_us + std::int64_t(load_little<std::uint32_t>(&record[4])));
    const auto number = [&](std::size_t i) { return load_little_float(&record[8 + 4 * i]); };
    for (std::size_t i = 0; i < 3; ++i) {
        sample.acceleration_g[i] = number(i);
        sample.gyro_dps[i] = number(3 + i);
        if (record.size() == Aedat3Packet::kImu9Bytes) sample.magnetic_ut[i] = number(7 + i);
    }
    sample.temperature_c = number(6);
    return sample;
}

void write_imu(const ImuSample& sample, bool with_magnetometer, std::uint32_t stamp,
               std::vector<std::byte>& out) {
    append_little<std::uint32_t>(out, 1);  // valid
    append_little(out, stamp);
    for (const float a : sample.acceleration_g) append_little_float(out, a);
    for (const float g : sample.gyro_dps) append_little_float(out, g);
    append_little_float(out, sample.temperature_c);
    if (!with_magnetometer) return;
    for (const float m : sample.magnetic_ut) append_little_float(out, m);
}

std::optional<ReferenceImage> read_frame(std::span<const std::byte> record, std::int64_t base_us,
                                         bool lower_left, int height) {
    const auto word = [&](std::size_t offset) {
        return load_little<std::uint32_t>(&record[offset]);
    };
    const std::uint32_t channels = (word(0) >> 1) & 7;
    const std::uint64_t width = word(20), rows = word(24), x0 = word(28), y0 = word(32);
    if (channels != 1 && channels != 3 && channels != 4) return {};
    if (width == 0 || rows == 0 || width > 65535 || rows > 65535 || x0 > 65535 || y0 > 65535)
        return {};
    const std::uint64_t n = width * rows * channels;
    if (Aedat3Packet::kFrameHeaderBytes + 2 * n > record.size()) return {};

    ReferenceImage image;
    image.exposure_begin = time_at(&record[12], base_us);
    image.exposure_end = time_at(&record[16], base_us);
    if (image.exposure_end < image.exposure_begin) return {};
    image.t = image.exposure_begin + (image.exposure_end - image.exposure_begin) / 2;
    image.x0 = int(x0);
    image.y0 = lower_left ? height - int(y0 + rows) : int(y0);
    image.channels = int(channels);
    if (channels == 1 && !lower_left)
        image.filter = colour_filter_of_number((word(0) >> 4) & 15).value_or(ColourFilter::none);
    image.pixels = Array2<std::uint16_t>(int(rows), int(width * channels));
    const std::byte* pixels = &record[Aedat3Packet::kFrameHeaderBytes - 1] + 1;
    for (std::size_t y = 0; y < rows; ++y) {
        const auto row = image.pixels.row(int(lower_left ? rows - 1 - y : y));
        for (std::size_t i = 0; i < row.size(); ++i, pixels += 2)
            row[swapped_channel(i, image.channels)] = load_little<std::uint16_t>(pixels);
    }
    return image;
}

void write_frame(const ReferenceImage& image, ColourFilter filter, std::int64_t base_us,
                 std::vector<std::byte>& out) {
    const auto stamp = [&](SensorTime t) { append_little(out, std::uint32_t(to_us(t) - base_us)); };
    append_little(out, 1U | std::uint32_t(image.channels) << 1 | number_of(filter) << 4);
    stamp(image.exposure_begin);  // start and end of the frame: not known better
    stamp(image.exposure_end);
    stamp(image.exposure_begin);
    stamp(image.exposure_end);
    append_little(out, std::uint32_t(image.pixels.width() / image.channels));
    append_little(out, std::uint32_t(image.pixels.height()));
    append_little(out, std::uint32_t(image.x0));
    append_little(out, std::uint32_t(image.y0));
    for (int y = 0; y < image.pixels.height(); ++y) {
        const auto row = image.pixels.row(y);
        for (std::size_t i = 0; i < row.size(); ++i)
            append_little(out, row[swapped_channel(i, image.channels)]);
    }
}

}  // namespace eventide
