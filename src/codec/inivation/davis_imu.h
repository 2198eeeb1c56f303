// Puts IMU samples together from the bytes in a DAVIS stream (docs/protocols.md A.11).
#pragma once

#include "src/codec/inivation/davis_sensor.h"
#include "src/core/event.h"

#include <array>
#include <cstdint>

namespace eventide {

class DavisImuAssembler {
public:
    enum class End : std::uint8_t { none, complete, incomplete };

    explicit DavisImuAssembler(const DavisSensor& sensor) : sensor_(sensor) {}

    bool begin();                   ///< true where the sample before did not end: it is lost
    void scale(std::uint8_t bits);  ///< misc8 kind 3
    void byte(std::uint8_t value);  ///< misc8 kind 0
    End end(SensorTime t, ImuSample& into);
    void abandon() { active_ = false; }

private:
    /// accel x y z, temperature, gyro x y z, each 16 bits, big-endian.
    static constexpr int kBytes = 14;
    void skip_missing_parts();
    int value(int index) const;
    float temperature_c() const;
    float gyro_range_dps() const;

    DavisSensor sensor_;
    bool active_ = false;
    std::array<std::uint8_t, kBytes> bytes_{};
    int count_ = 0;
    int accel_scale_ = 1, gyro_scale_ = 1;
    bool has_accel_ = true, has_gyro_ = true, has_temperature_ = true;
};

}  // namespace eventide
