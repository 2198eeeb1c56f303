#include "tests/support/usb/davis_writer.h"

#include "src/core/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

namespace eventide::testing_support {
namespace {

constexpr std::int64_t kWrapUs = 1 << 15;
constexpr std::int64_t kMaxWrapsInAWord = 0xFFF;
constexpr std::uint16_t kReset = 1023;  // ADC level of a pixel that has just been reset

void put(std::uint16_t word, std::vector<std::byte>& out) {
    out.push_back(std::byte(word & 0xFF));
    out.push_back(std::byte(word >> 8));
}
void put(int code, int data, std::vector<std::byte>& out) {
    put(std::uint16_t((code << 12) | data), out);
}
void put_special(int data, std::vector<std::byte>& out) {
    put(0, data, out);
}

/// A thing to say at a time; things of equal time keep their order.
struct Item {
    std::int64_t t;
    std::function<void()> say;
};

}  // namespace

void DavisWriter::timestamp_reset(std::vector<std::byte>& out) {
    put_special(1, out);
}

void DavisWriter::write(const Batch& batch, std::vector<std::byte>& out) {
    // Few things are not events: they are sorted, and said between the events as their time comes.
    std::vector<Item> others;
    for (const auto& image : batch.images) {
        others.push_back({to_us(image.exposure_begin), [&] { image_reset(image, out); }});
        others.push_back({to_us(image.exposure_end), [&] { image_signal(image, out); }});
    }
    for (const auto& sample : batch.imu)
        others.push_back({to_us(sample.t), [&] { imu(sample, out); }});
    for (const auto& edge : batch.triggers)
        others.push_back({to_us(edge.t), [&] { trigger(edge, out); }});
    std::stable_sort(others.begin(), others.end(),
                     [](const Item& a, const Item& b) { return a.t < b.t; });

    auto next = others.begin();
    const auto say_until = [&](std::int64_t t) {
        for (; next != others.end() && next->t <= t; ++next) {
            time_word(std::max(next->t, time_), out);
            next->say();
        }
    };
    for (const Event& e : batch.events) {
        say_until(to_us(e.t) - 1);
        event(e, out);
    }
    say_until(INT64_MAX);
}

void DavisWriter::time_word(std::int64_t t, std::vector<std::byte>& out) {
    if (t < time_)
        throw Error(ErrorKind::usage, "DAVIS words: time " + std::to_string(t) +
                                          " us comes after " + std::to_string(time_) + " us");
    if (time_sent_ && t == time_) return;
    while (t - wrap_add_ >= kWrapUs) {
        const std::int64_t wraps = std::min((t - wrap_add_) / kWrapUs, kMaxWrapsInAWord);
        put(7, int(wraps), out);
        wrap_add_ += wraps * kWrapUs;
    }
    put(std::uint16_t(0x8000 | (t - wrap_add_)), out);
    time_ = t;
    time_sent_ = true;
}

void DavisWriter::event(const Event& event, std::vector<std::byte>& out) {
    if (event.x >= sensor_.width() || event.y >= sensor_.height())
        throw Error(ErrorKind::usage, "DAVIS words: event at " + std::to_string(event.x) + "," +
                                          std::to_string(event.y) + " is outside the sensor");
    const int column = sensor_.dvs_swapped ? event.y : event.x;
    const int row = sensor_.dvs_swapped ? event.x : event.y;
    // Rows are addressed once for all their events of one time.
    if (!time_sent_ || to_us(event.t) != time_) y_ = -1;
    time_word(to_us(event.t), out);
    if (row != y_) put(1, row, out);
    y_ = row;
    put(event.polarity == Polarity::on ? 3 : 2, column, out);
}

void DavisWriter::image_reset(const ReferenceImage& image, std::vector<std::byte>& out) {
    const int width = image.pixels.width(), height = image.pixels.height();
    if (image.channels != 1 || image.x0 < 0 || image.y0 < 0 || width < 1 || height < 1 ||
        image.x0 + width > sensor_.aps_width() || image.y0 + height > sensor_.aps_height())
        throw Error(ErrorKind::usage,
                    "DAVIS words: only grey images inside the sensor can be sent, not " +
                        std::to_string(width) + "x" + std::to_string(height) + " with " +
                        std::to_string(image.channels) + " channels");
    put_special(8, out);
    for (const int corner : {image.x0, image.y0, image.x0 + width - 1, image.y0 + height - 1}) {
        put(5, 0x100 | (corner >> 8), out);
        put(5, 0x200 | (corner & 0xFF), out);
    }
    columns(image, false, out);
    put_special(14, out);
}

void DavisWriter::image_signal(const ReferenceImage& image, std::vector<std::byte>& out) {
    put_special(15, out);
    columns(image, true, out);
    const double exposure_us = double((image.exposure_end - image.exposure_begin).count());
    constexpr double kAdcMhz = 30;
    const auto cycles = std::uint32_t(exposure_us * kAdcMhz);
    for (int shift : {0, 10, 20}) put(6, int((cycles >> shift) & 0x3FF), out);
    put_special(10, out);
}

void DavisWriter::columns(const ReferenceImage& image, bool signal,
                          std::vector<std::byte>& out) const {
    const int columns = sensor_.aps_swapped ? image.pixels.height() : image.pixels.width();
    const int rows = sensor_.aps_swapped ? image.pixels.width() : image.pixels.height();
    for (int column = 0; column < columns; ++column) {
        put_special(signal ? 12 : 11, out);
        for (int row = 0; row < rows; ++row) {
            const int x = sensor_.aps_flip_x ? columns - 1 - column : column;
            const int y = sensor_.aps_flip_y ? rows - 1 - row : row;
            const int value = (sensor_.aps_swapped ? image.pixels(x, y) : image.pixels(y, x)) >> 6;
            const int level = signal ? kReset - value : kReset;
            // DAVIS240 sends half of what the samples mean.
            put(4, sensor_.is_davis240() ? (level + 1) / 2 : level, out);
        }
        put_special(13, out);
    }
}

void DavisWriter::imu(const ImuSample& sample, std::vector<std::byte>& out) {
    constexpr float kAccelLsbPerG = 65536.0F / 8, kGyroLsbPerDps = 65536.0F / 1000;
    const std::array<float, 3> sign{sensor_.imu_flip_x ? -1.F : 1.F,
                                    sensor_.imu_flip_y ? -1.F : 1.F,
                                    sensor_.imu_flip_z ? -1.F : 1.F};
    const auto number = [&](float value) {
        const auto bits =
            std::uint16_t(std::int16_t(std::lround(std::clamp(value, -32768.F, 32767.F))));
        put(5, bits >> 8, out);
        put(5, bits & 0xFF, out);
    };
    put_special(5, out);
    put(5, 0x300 | 0xE0 | (1 << 2) | 1, out);  // all parts, +-4 g, +-500 deg/s
    for (std::size_t a = 0; a < 3; ++a) number(sign[a] * sample.acceleration_g[a] * kAccelLsbPerG);
    number(sensor_.imu_type == 2 ? (sample.temperature_c - 21) * 333.87F
                                 : (sample.temperature_c - 35) * 340);
    for (std::size_t a = 0; a < 3; ++a) number(sign[a] * sample.gyro_dps[a] * kGyroLsbPerDps);
    put_special(7, out);
}

void DavisWriter::trigger(const Trigger& trigger, std::vector<std::byte>& out) {
    switch (trigger.kind) {
        case Trigger::Kind::falling:
            return put_special(trigger.source == 0 ? 2 : 16, out);
        case Trigger::Kind::rising:
            return put_special(trigger.source == 0 ? 3 : 17, out);
        case Trigger::Kind::pulse:
            return put_special(4, out);
        default:
            return;  // marks that the camera makes itself: resets, frames
    }
}

}  // namespace eventide::testing_support
