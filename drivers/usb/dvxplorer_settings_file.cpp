// config/cameras/*.toml -> DvxplorerSettings.
#include "drivers/settings_file.h"
#include "drivers/usb/dvxplorer_settings.h"

namespace eventide {

DvxplorerSettings load_dvxplorer_settings(const std::filesystem::path& file) {
    constexpr int kMaxThreshold = 17, kMax16Bits = 65535;
    DvxplorerSettings settings;
    read_camera_settings(
        file,
        {whole_setting("contrast_on", settings.contrast_on, 0, kMaxThreshold),
         whole_setting("contrast_off", settings.contrast_off, 0, kMaxThreshold),
         region_setting("roi", settings.roi), polarity_setting(settings.polarity),
         one_of_setting("subsample", settings.subsample, {1, 2, 4, 8}),
         flag_setting("activity_decision", settings.activity_decision),
         whole_setting("activity_positive", settings.activity_positive, 0, kMax16Bits),
         whole_setting("activity_negative", settings.activity_negative, 0, kMax16Bits),
         flag_setting("imu", settings.imu),
         one_of_setting("accel_range_g", settings.accel_range_g, {2, 4, 8, 16}),
         one_of_setting("gyro_range_dps", settings.gyro_range_dps, {125, 250, 500, 1000, 2000}),
         flag_setting("detect_pulses", settings.detect_pulses),
         flag_setting("detect_edges", settings.detect_edges), transfers_setting(settings.transfers),
         transfer_size_setting(settings.transfers),
         whole_setting("early_packet_delay_us", settings.early_packet_delay_us, 125, 100000),
         flag_setting("verify", settings.verify)});
    return settings;
}

}  // namespace eventide
