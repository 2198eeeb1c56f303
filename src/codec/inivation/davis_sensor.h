// What a DAVIS parser must know about the camera: read from its registers when it is opened.
#pragma once

#include <eventide/event.h>

#include <cstdint>

namespace eventide {

/// Chip ids as SYSINFO register 1 gives them (docs/protocols.md A.1).
enum class DavisChip : std::uint8_t {
    davis240a = 0,
    davis240b = 1,
    davis240c = 2,
    davis128 = 3,
    davis346a = 4,
    davis346b = 5,
    davis640 = 6,
    davis640h = 7,
    davis208 = 8,
    davis346c = 9
};

/// IMU types as IMU register 0 gives them; the last is our own number for the one in DVXplorer.
enum ImuType : int { kNoImu = 0, kImuMpu6050 = 1, kImuMpu6500 = 2, kImuBmi160 = 3 };

/// Sizes are in DEVICE axes: registers DVS 0-2 and APS 0-2. DAVIS346 says columns 260, rows 346 and
/// swapped axes.
struct DavisSensor {
    DavisChip chip = DavisChip::davis346b;
    int dvs_columns = 260, dvs_rows = 346;
    bool dvs_swapped = true;  ///< orientation bit 2
    int aps_columns = 260, aps_rows = 346;
    bool aps_swapped = true, aps_flip_x = false, aps_flip_y = false;  ///< orientation bits 2, 1, 0
    ColourFilter colour_filter = ColourFilter::none;  ///< APS 3, of the image as it is given
    int imu_type = kImuMpu6050;
    bool imu_flip_x = false, imu_flip_y = false,
         imu_flip_z = false;  ///< IMU orientation bits 2, 1, 0

    int width() const { return dvs_swapped ? dvs_rows : dvs_columns; }  ///< px, as a person sees it
    int height() const { return dvs_swapped ? dvs_columns : dvs_rows; }
    int aps_width() const { return aps_swapped ? aps_rows : aps_columns; }
    int aps_height() const { return aps_swapped ? aps_columns : aps_rows; }

    bool is_davis240() const { return chip <= DavisChip::davis240c; }

    friend bool operator==(const DavisSensor&, const DavisSensor&) = default;
};

}  // namespace eventide
