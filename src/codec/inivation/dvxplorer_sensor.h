// What the words of a DVXplorer do not say about themselves, alike for both of its boards.
#pragma once

#include "src/codec/inivation/davis_sensor.h"
#include "src/core/event.h"

#include <cstdint>

namespace eventide {

constexpr int kDvxplorerRowsPerGroup = 8;  ///< of the masks that events come as

struct DvxplorerSensor {
    int width = 640, height = 480;  ///< px, as a person sees it; Lite: 320x240
    bool swapped = false;           ///< orientation bit 2: the chip's columns are the frame's rows
    bool imu_flip_x = false, imu_flip_y = false,
         imu_flip_z = false;  ///< IMU orientation bits 2, 1, 0

    int columns() const { return swapped ? height : width; }
    int rows() const { return swapped ? width : height; }

    friend bool operator==(const DvxplorerSensor&, const DvxplorerSensor&) = default;
};

/// Its IMU, for DavisImuAssembler.
inline DavisSensor imu_of(const DvxplorerSensor& sensor) {
    DavisSensor imu;
    imu.imu_type = kImuBmi160;
    imu.imu_flip_x = sensor.imu_flip_x;
    imu.imu_flip_y = sensor.imu_flip_y;
    imu.imu_flip_z = sensor.imu_flip_z;
    return imu;
}

/// The event of a pixel of the chip, where a person sees it.
inline Event event_at(SensorTime t, int column, int row, Polarity polarity,
                      const DvxplorerSensor& sensor) {
    const auto x = std::uint16_t(column), y = std::uint16_t(row);
    return sensor.swapped ? Event{t, y, x, polarity} : Event{t, x, y, polarity};
}

}  // namespace eventide
