// config/cameras/*.toml -> DvxplorerSettings.
#include "drivers/settings_file.h"
#include "drivers/usb/dvxplorer_settings.h"

namespace eventide {

DvxplorerSettings load_dvxplorer_settings(const std::filesystem::path& file) {
    constexpr int kMaxThreshold = 17, kMost16Bits = 65535;
    DvxplorerSettings settings;
    SettingsFile reader{file};
    reader.number("contrast_on", settings.contrast_on, 0, kMaxThreshold);
    reader.number("contrast_off", settings.contrast_off, 0, kMaxThreshold);
    add_region(reader, "roi", settings.roi);
    add_polarity(reader, "polarity", settings.polarity);
    reader.choice("subsample", settings.subsample, {1, 2, 4, 8});
    reader.flag("activity_decision", settings.activity_decision);
    reader.number("activity_positive", settings.activity_positive, 0, kMost16Bits);
    reader.number("activity_negative", settings.activity_negative, 0, kMost16Bits);
    reader.flag("imu", settings.imu);
    reader.choice("accel_range_g", settings.accel_range_g, {2, 4, 8, 16});
    reader.choice("gyro_range_dps", settings.gyro_range_dps, {125, 250, 500, 1000, 2000});
    reader.flag("detect_pulses", settings.detect_pulses);
    reader.flag("detect_edges", settings.detect_edges);
    add_transfers(reader, settings.transfers);
    reader.number("early_packet_delay_us", settings.early_packet_delay_us, 125, 100000);
    reader.flag("verify", settings.verify);
    reader.read();
    return settings;
}

}  // namespace eventide
