#include "src/codec/inivation/davis_frame.h"

#include "src/codec/inivation/davis_pixel.h"

#include <algorithm>
#include <utility>

namespace eventide {
namespace {

constexpr int kRoiBytes = 8;

SensorTime middle(SensorTime a, SensorTime b) {
    return a + (b - a) / 2;
}

}  // namespace

DavisFrameAssembler::DavisFrameAssembler(const DavisSensor& sensor) : sensor_(sensor) {
    use_roi(0, 0, sensor_.aps_width() - 1, sensor_.aps_height() - 1);
}

void DavisFrameAssembler::use_roi(int x0, int y0, int x1, int y1) {
    const int right = sensor_.aps_width() - 1, bottom = sensor_.aps_height() - 1;
    x0 = std::clamp(x0, 0, right);
    y0 = std::clamp(y0, 0, bottom);
    roi_ = {x0, y0, std::clamp(x1, x0, right), std::clamp(y1, y0, bottom)};
    for (auto& samples : samples_)
        samples.assign(std::size_t(device_columns()) * std::size_t(device_rows()), 0);
}

bool DavisFrameAssembler::begin(Shutter shutter, SensorTime t) {
    const bool was_active = std::exchange(active_, true);
    shutter_ = shutter;
    roi_count_ = 0;
    columns_ = {};
    row_ = 0;
    in_column_ = short_column_ = false;
    sampled_ = {};
    exposure_begin_ = exposure_end_ = t;
    return was_active;
}

void DavisFrameAssembler::roi_byte(std::uint8_t value) {
    if (!active_ || roi_count_ >= kRoiBytes) return;
    roi_bytes_[std::size_t(roi_count_++)] = value;
    if (roi_count_ < kRoiBytes) return;
    const auto number = [&](int i) {
        return (roi_bytes_[std::size_t(2 * i)] << 8) | roi_bytes_[std::size_t(2 * i + 1)];
    };
    use_roi(number(0), number(1), number(2), number(3));
}

void DavisFrameAssembler::column_begin(Read read) {
    if (!active_) return;
    read_ = read;
    row_ = 0;
    in_column_ = true;
}

void DavisFrameAssembler::sample(std::uint16_t adc, SensorTime t) {
    if (!active_ || !in_column_) return;
    const auto read = std::size_t(read_);
    // A.10: exposure starts with the last reset sample (global shutter) or the first (rolling),
    // unless the device marks it, and ends with the first signal sample.
    if (read_ == Read::reset && (shutter_ == Shutter::global || !sampled_[read]))
        exposure_begin_ = t;
    if (read_ == Read::signal && !sampled_[read]) exposure_end_ = t;
    sampled_[read] = true;

    const int column = columns_[read];
    if (column < device_columns() && row_ < device_rows())
        samples_[read][std::size_t(column) * std::size_t(device_rows()) + std::size_t(row_)] =
            davis_sample(adc, sensor_.is_davis240());
    ++row_;
}

void DavisFrameAssembler::column_end() {
    if (!active_ || !in_column_) return;
    in_column_ = false;
    if (row_ < device_rows()) short_column_ = true;
    ++columns_[std::size_t(read_)];
}

DavisFrameAssembler::End DavisFrameAssembler::end(SensorTime t, ReferenceImage& into) {
    if (!active_) return End::none;
    active_ = false;
    if (short_column_ || columns_[0] != device_columns() || columns_[1] != device_columns())
        return End::incomplete;
    if (exposure_end_ < exposure_begin_) exposure_end_ = t;
    into.exposure_begin = exposure_begin_;
    into.exposure_end = exposure_end_;
    into.t = middle(exposure_begin_, exposure_end_);
    into.x0 = roi_[0];
    into.y0 = roi_[1];
    into.channels = 1;
    write_image(into);
    return End::complete;
}

std::uint16_t DavisFrameAssembler::pixel(int column, int row) const {
    const std::size_t at = std::size_t(column) * std::size_t(device_rows()) + std::size_t(row);
    return davis_intensity(samples_[0][at], samples_[1][at]);
}

void DavisFrameAssembler::write_image(ReferenceImage& into) const {
    into.pixels = Array2<std::uint16_t>{roi_height(), roi_width()};
    for (int column = 0; column < device_columns(); ++column)
        for (int row = 0; row < device_rows(); ++row) {
            const int x = sensor_.aps_flip_x ? device_columns() - 1 - column : column;
            const int y = sensor_.aps_flip_y ? device_rows() - 1 - row : row;
            if (sensor_.aps_swapped)
                into.pixels(x, y) = pixel(column, row);
            else
                into.pixels(y, x) = pixel(column, row);
        }
}

}  // namespace eventide
