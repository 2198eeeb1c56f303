#include "tests/support/usb/dvxplorer_words.h"

#include "src/core/byte_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace eventide::testing_support {
namespace {

constexpr int kRowsPerGroup = 8;

/// Events of one time, column, polarity and group of eight rows, in rising rows.
struct Octet {
    std::int64_t t;
    int column, group, mask;
    bool off;
};

std::vector<Octet> octets_of(std::span<const Event> events, const DvxplorerSensor& sensor) {
    std::vector<Octet> octets;
    for (const Event& event : events) {
        const auto [column, row] = device_axes(event, sensor);
        const Octet one{to_us(event.t), column, row / kRowsPerGroup, 1 << (row % kRowsPerGroup),
                        event.polarity == Polarity::off};
        if (!octets.empty()) {
            Octet& last = octets.back();
            if (last.t == one.t && last.column == one.column && last.group == one.group &&
                last.off == one.off && last.mask < one.mask) {
                last.mask |= one.mask;
                continue;
            }
        }
        octets.push_back(one);
    }
    return octets;
}

/// Whether the octet after `at` fits into the same group word: same time and column, and not
/// farther than the offset can say.
bool has_partner(const std::vector<Octet>& octets, std::size_t at, bool may_be_before) {
    constexpr int kFarthest = 31;
    if (at + 1 >= octets.size()) return false;
    const Octet &a = octets[at], &b = octets[at + 1];
    const int offset = b.group - a.group;
    return a.t == b.t && a.column == b.column && std::abs(offset) <= kFarthest &&
           (may_be_before || offset >= 0);
}

struct ImuScales {
    float accel_lsb, gyro_lsb;  ///< per g, per deg/s
    std::array<float, 3> sign;
};

ImuScales imu_scales(const DvxplorerSensor& sensor, const ImuRanges& ranges) {
    return {32768.F / float(2 << ranges.accel),
            32768.F / float(2000 >> ranges.gyro),
            {sensor.imu_flip_x ? -1.F : 1.F, sensor.imu_flip_y ? -1.F : 1.F,
             sensor.imu_flip_z ? -1.F : 1.F}};
}

class Fx3Words {
public:
    Fx3Words(const ImuRanges& ranges, bool after_reset) : ranges_(ranges) {
        if (after_reset) put(0, 1);
    }

    void time(std::int64_t t) {
        constexpr std::int64_t kWrapUs = 1 << 15;
        if (t == time_) return;
        if (const std::int64_t wraps = (t - wrap_add_) / kWrapUs; wraps > 0) {
            put(7, int(wraps));
            wrap_add_ += wraps * kWrapUs;
        }
        append_little(bytes_, std::uint16_t(0x8000 | (t - wrap_add_)));
        time_ = t;
        column_ = -1;
    }
    /// Returns how many octets it said.
    std::size_t octets(const std::vector<Octet>& octets, std::size_t at) {
        const Octet& a = octets[at];
        constexpr int kFrameBegins = 0x800, kBefore = 0x800;
        if (a.column != column_) put(1, a.column | (column_ < 0 ? kFrameBegins : 0));
        column_ = a.column;
        const bool two = has_partner(octets, at, true);
        const int offset = two ? octets[at + 1].group - a.group : 0;
        put(4, a.group | (std::abs(offset) << 6) | (offset < 0 ? kBefore : 0));
        put(3, a.mask | (a.off ? 0x100 : 0));
        if (two) put(2, octets[at + 1].mask | (octets[at + 1].off ? 0x100 : 0));
        return two ? 2 : 1;
    }
    void imu(const ImuSample& sample, const DvxplorerSensor& sensor) {
        constexpr std::array<std::size_t, 3> kSent{1, 0, 2};  // y before x
        const auto [accel_lsb, gyro_lsb, sign] = imu_scales(sensor, ranges_);
        put(0, 5);
        put(5, 0x300 | 0xE0 | (ranges_.accel << 3) | ranges_.gyro);
        for (const std::size_t a : kSent) number(sign[a] * sample.acceleration_g[a] * accel_lsb);
        number((sample.temperature_c - 23) * 512);
        for (const std::size_t a : kSent) number(sign[a] * sample.gyro_dps[a] * gyro_lsb);
        put(0, 7);
    }
    void trigger(const Trigger& trigger) {
        const int word = trigger.kind == Trigger::Kind::falling  ? 2
                         : trigger.kind == Trigger::Kind::rising ? 3
                                                                 : 4;
        put(0, word);
    }
    std::vector<std::byte> take() { return std::move(bytes_); }

private:
    void put(int code, int data) { append_little(bytes_, std::uint16_t((code << 12) | data)); }
    void number(float value) {
        const auto bits = std::uint16_t(std::int16_t(std::lround(value)));
        put(5, bits >> 8);
        put(5, bits & 0xFF);
    }

    ImuRanges ranges_;
    std::vector<std::byte> bytes_;
    std::int64_t wrap_add_ = 0, time_ = -1;
    int column_ = -1;
};

}  // namespace

std::pair<int, int> device_axes(const Event& event, const DvxplorerSensor& sensor) {
    return sensor.swapped ? std::pair<int, int>{event.y, event.x}
                          : std::pair<int, int>{event.x, event.y};
}

std::vector<std::byte> fx3_words(const Batch& scene, const DvxplorerSensor& sensor,
                                 const ImuRanges& ranges, bool after_reset) {
    Fx3Words words{ranges, after_reset};
    const auto octets = octets_of(scene.events, sensor);
    std::size_t imu = 0, trigger = 0;
    const auto time_of = [](const auto& items, std::size_t next) {
        return next < items.size() ? to_us(items[next].t) : INT64_MAX;
    };
    const auto others_until = [&](std::int64_t t) {
        for (;;) {
            const std::int64_t a = time_of(scene.triggers, trigger), b = time_of(scene.imu, imu);
            if (std::min(a, b) > t || std::min(a, b) == INT64_MAX) return;
            words.time(std::min(a, b));
            if (a <= b)
                words.trigger(scene.triggers[trigger++]);
            else
                words.imu(scene.imu[imu++], sensor);
        }
    };
    for (std::size_t at = 0; at < octets.size();) {
        others_until(octets[at].t);
        words.time(octets[at].t);
        at += words.octets(octets, at);
    }
    others_until(INT64_MAX);
    return words.take();
}

std::vector<std::byte> mini_imu(const ImuSample& sample, const DvxplorerSensor& sensor,
                                const ImuRanges& ranges) {
    constexpr std::uint8_t kImu = 1, kEverything = 0xE0;
    const ImuScales scales = imu_scales(sensor, ranges);
    std::vector<std::byte> bytes{std::byte{kImu},
                                 std::byte(kEverything | (ranges.accel << 3) | ranges.gyro)};
    const auto number = [&](float value) {
        append_little(bytes, std::int16_t(std::lround(value)));
    };
    for (const std::size_t a : {2, 1, 0})
        number(scales.sign[a] * sample.gyro_dps[a] * scales.gyro_lsb);
    for (const std::size_t a : {2, 1, 0})
        number(scales.sign[a] * sample.acceleration_g[a] * scales.accel_lsb);
    number((sample.temperature_c - 23) * 512);
    return bytes;
}

MiniStream mini_stream(const Batch& scene, const DvxplorerSensor& sensor, const ImuRanges& ranges) {
    MiniStream stream;
    const auto put = [&](std::uint32_t word) { append_little(stream.words, word); };
    std::int64_t reference_ms = -1, time = -1;
    const auto reference = [&](std::int64_t ms) {
        if (ms != reference_ms) put(0x08000000U | std::uint32_t(reference_ms = ms));
    };
    std::size_t imu = 0;
    const auto imu_until = [&](std::int64_t ms) {
        for (; imu < scene.imu.size() && to_us(scene.imu[imu].t) / 1000 <= ms; ++imu) {
            reference(to_us(scene.imu[imu].t) / 1000);
            stream.messages.push_back(
                {stream.words.size(), mini_imu(scene.imu[imu], sensor, ranges)});
        }
    };
    const auto octets = octets_of(scene.events, sensor);
    int column = -1;
    reference(0);
    for (std::size_t at = 0; at < octets.size();) {
        const Octet& a = octets[at];
        if (a.t / 1000 != reference_ms) imu_until(a.t / 1000);
        reference(a.t / 1000);
        if (a.t != time)
            put(0x04000000U | (1U << 21) | (std::uint32_t(a.t % 1000) << 11) |
                std::uint32_t(a.column));
        else if (a.column != column)
            put(0x04000000U | std::uint32_t(a.column));
        time = a.t;
        column = a.column;
        const bool two = has_partner(octets, at, false);
        const Octet b = two ? octets[at + 1] : Octet{a.t, a.column, a.group, 0, false};
        put((1U << 31) | (std::uint32_t(b.group - a.group) << 26) | (std::uint32_t(a.group) << 18) |
            (b.off ? 1U << 17 : 0) | (a.off ? 1U << 16 : 0) | (std::uint32_t(b.mask) << 8) |
            std::uint32_t(a.mask));
        put(0);  // padding
        at += two ? 2 : 1;
    }
    imu_until(INT64_MAX);
    return stream;
}

}  // namespace eventide::testing_support
