#include "src/codec/inivation/davis_imu.h"

#include <utility>

namespace eventide {
namespace {
constexpr int kAccelEnd = 6, kTemperatureEnd = 8, kGyroEnd = 14;
}

bool DavisImuAssembler::begin() {
    const bool was_active = std::exchange(active_, true);
    count_ = 0;
    bytes_.fill(0);
    return was_active;
}

/// Parts present 7-5 (accel, gyro, temperature). MPU: accel scale 3-2, gyro scale 1-0; BMI160: 4-3
/// and 2-0.
void DavisImuAssembler::scale(std::uint8_t bits) {
    if (!active_) return;
    const bool bmi160 = sensor_.imu_type == kImuBmi160;
    gyro_scale_ = bmi160 ? bits & 7 : bits & 3;
    accel_scale_ = bmi160 ? (bits >> 3) & 3 : (bits >> 2) & 3;
    has_accel_ = (bits & 0x80) != 0;
    has_gyro_ = (bits & 0x40) != 0;
    has_temperature_ = (bits & 0x20) != 0;
    skip_missing_parts();
}

void DavisImuAssembler::skip_missing_parts() {
    if (count_ == 0 && !has_accel_) count_ = kAccelEnd;
    if (count_ == kAccelEnd && !has_temperature_) count_ = kTemperatureEnd;
    if (count_ == kTemperatureEnd && !has_gyro_) count_ = kGyroEnd;
}

void DavisImuAssembler::byte(std::uint8_t value) {
    if (!active_ || count_ >= kBytes) return;
    bytes_[std::size_t(count_++)] = value;
    skip_missing_parts();
}

int DavisImuAssembler::value(int index) const {
    const auto at = std::size_t(2 * index);
    return std::int16_t(std::uint16_t((bytes_[at] << 8) | bytes_[at + 1]));
}

float DavisImuAssembler::temperature_c() const {
    if (!has_temperature_) return 0;
    switch (sensor_.imu_type) {
        case kImuMpu6500:
            return float(value(3)) / 333.87F + 21.F;
        case kImuBmi160:
            return float(value(3)) / 512.F + 23.F;
        default:
            return float(value(3)) / 340.F + 35.F;
    }
}

/// MPU: 250 doubled with the scale; BMI160: 2000 halved with it.
float DavisImuAssembler::gyro_range_dps() const {
    return sensor_.imu_type == kImuBmi160 ? 2000.F / float(1 << gyro_scale_)
                                          : float(250 << gyro_scale_);
}

DavisImuAssembler::End DavisImuAssembler::end(SensorTime t, ImuSample& into) {
    if (!active_) return End::none;
    active_ = false;
    if (count_ != kBytes) return End::incomplete;

    constexpr float kFullScale = 32768;
    const float g_per_lsb = float(2 << accel_scale_) / kFullScale;
    const float dps_per_lsb = gyro_range_dps() / kFullScale;
    const std::array<float, 3> sign{sensor_.imu_flip_x ? -1.F : 1.F,
                                    sensor_.imu_flip_y ? -1.F : 1.F,
                                    sensor_.imu_flip_z ? -1.F : 1.F};
    // BMI160 sends Y before X.
    const std::array<int, 3> order =
        sensor_.imu_type == kImuBmi160 ? std::array{1, 0, 2} : std::array{0, 1, 2};
    into = {};
    into.t = t;
    into.temperature_c = temperature_c();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        into.acceleration_g[axis] = sign[axis] * float(value(order[axis])) * g_per_lsb;
        into.gyro_dps[axis] = sign[axis] * float(value(4 + order[axis])) * dps_per_lsb;
    }
    return End::complete;
}

}  // namespace eventide
