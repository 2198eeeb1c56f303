#include "src/codec/davis_imu.h"

namespace eventide {
namespace {
constexpr int kAccelEnd = 6, kTemperatureEnd = 8, kGyroEnd = 14;
}

void DavisImuAssembler::begin() {
    active_ = true;
    count_ = 0;
    bytes_.fill(0);
}

void DavisImuAssembler::scale(std::uint8_t bits) {
    if (!active_) return;
    gyro_scale_ = bits & 3;
    accel_scale_ = (bits >> 2) & 3;
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

DavisImuAssembler::End DavisImuAssembler::end(SensorTime t, ImuSample& into) {
    if (!active_) return End::none;
    active_ = false;
    if (count_ != kBytes) return End::incomplete;

    // Full scale 2 g << s over +-32768, and 250 deg/s << s.
    const float accel_lsb_per_g = float(65536 / (4 << accel_scale_));
    const float gyro_lsb_per_dps = 65536.0F / float(500 << gyro_scale_);
    const std::array<float, 3> sign{sensor_.imu_flip_x ? -1.F : 1.F,
                                    sensor_.imu_flip_y ? -1.F : 1.F,
                                    sensor_.imu_flip_z ? -1.F : 1.F};
    into = {};
    into.t = t;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = std::size_t(axis);
        into.acceleration_g[a] = sign[a] * float(value(axis)) / accel_lsb_per_g;
        into.gyro_dps[a] = sign[a] * float(value(4 + axis)) / gyro_lsb_per_dps;
    }
    if (has_temperature_)
        into.temperature_c = sensor_.imu_type == 2 ? float(value(3)) / 333.87F + 21.F
                                                   : float(value(3)) / 340.F + 35.F;
    return End::complete;
}

}  // namespace eventide
