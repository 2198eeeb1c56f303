// config/cameras/*.toml -> DavisSettings.
#include "drivers/settings_file.h"
#include "drivers/usb/davis_settings.h"

namespace eventide {
namespace {

Setting hot_pixels_setting(std::vector<std::pair<int, int>>& into) {
    return file_setting("hot_pixels", [&into](const SettingValue& value) {
        constexpr std::size_t kMaxPixels = 8;
        constexpr int kMax = 1023;
        if (value.kind != ValueKind::list || value.items.size() > kMaxPixels)
            value.refuse("a list of up to eight [x, y]");
        for (const SettingValue& pixel : value.items) {
            if (pixel.kind != ValueKind::list || pixel.items.size() != 2) pixel.refuse("[x, y]");
            into.emplace_back(int(whole_of(pixel.items[0], 0, kMax)),
                              int(whole_of(pixel.items[1], 0, kMax)));
        }
    });
}

}  // namespace

DavisSettings load_davis_settings(const std::filesystem::path& file) {
    constexpr std::uint32_t kMax16Bits = 0xFFFF;
    DavisSettings settings;
    read_camera_settings(
        file, {flag_setting("frames", settings.frames),
               region_setting("frame_roi", settings.frame_roi),
               flag_setting("global_shutter", settings.global_shutter),
               whole_setting("exposure_us", settings.exposure_us, 0, 4194303),
               whole_setting("frame_interval_us", settings.frame_interval_us, 0, 8388607),
               flag_setting("auto_exposure", settings.auto_exposure),
               flag_setting("imu", settings.imu),
               one_of_setting("accel_range_g", settings.accel_range_g, {2, 4, 8, 16}),
               one_of_setting("gyro_range_dps", settings.gyro_range_dps, {250, 500, 1000, 2000}),
               flag_setting("activity_filter", settings.activity_filter),
               whole_setting("activity_time_us", settings.activity_time_us, 250, 1000000),
               whole_setting("refractory_us", settings.refractory_us, 0, 1000000),
               region_setting("roi", settings.roi),
               polarity_setting(settings.polarity),
               hot_pixels_setting(settings.hot_pixels),
               whole_setting("skip_every", settings.skip_every, 0, 255),
               flag_setting("detect_pulses", settings.detect_pulses),
               flag_setting("detect_edges", settings.detect_edges),
               transfers_setting(settings.transfers),
               transfer_size_setting(settings.transfers),
               whole_setting("early_packet_delay_us", settings.early_packet_delay_us, 125, 100000),
               flag_setting("verify", settings.verify),
               biases_setting(settings.biases, kMax16Bits)});
    return settings;
}

}  // namespace eventide
