// config/cameras/*.toml -> DavisSettings.
#include "drivers/settings_file.h"
#include "drivers/usb/davis_settings.h"

namespace eventide {
namespace {

void add_hot_pixels(SettingsFile& file, std::vector<std::pair<int, int>>& into) {
    constexpr std::size_t kMaxPixels = 8;
    constexpr int kMax = 1023;
    file.custom("hot_pixels", [&file, &into](const toml::node& node) {
        const toml::array* pixels = node.as_array();
        if (pixels == nullptr || pixels->size() > kMaxPixels)
            file.refuse(node, "hot_pixels: expected a list of up to eight [x, y]");
        for (const toml::node& pixel : *pixels) {
            const toml::array* place = pixel.as_array();
            if (place == nullptr || place->size() != 2)
                file.refuse(pixel, "hot_pixels: expected [x, y]");
            into.emplace_back(int(file.checked(*place->get(0), "hot_pixels", 0, kMax)),
                              int(file.checked(*place->get(1), "hot_pixels", 0, kMax)));
        }
    });
}

}  // namespace

DavisSettings load_davis_settings(const std::filesystem::path& file) {
    constexpr std::uint32_t kMost16Bits = 0xFFFF;
    DavisSettings settings;
    SettingsFile reader{file};
    reader.flag("frames", settings.frames);
    add_region(reader, "frame_roi", settings.frame_roi);
    reader.flag("global_shutter", settings.global_shutter);
    reader.number("exposure_us", settings.exposure_us, 0, 4194303);
    reader.number("frame_interval_us", settings.frame_interval_us, 0, 8388607);
    reader.flag("auto_exposure", settings.auto_exposure);
    reader.flag("imu", settings.imu);
    reader.choice("accel_range_g", settings.accel_range_g, {2, 4, 8, 16});
    reader.choice("gyro_range_dps", settings.gyro_range_dps, {250, 500, 1000, 2000});
    reader.flag("activity_filter", settings.activity_filter);
    reader.number("activity_time_us", settings.activity_time_us, 250, 1000000);
    reader.number("refractory_us", settings.refractory_us, 0, 1000000);
    add_region(reader, "roi", settings.roi);
    add_polarity(reader, "polarity", settings.polarity);
    add_hot_pixels(reader, settings.hot_pixels);
    reader.number("skip_every", settings.skip_every, 0, 255);
    reader.flag("detect_pulses", settings.detect_pulses);
    reader.flag("detect_edges", settings.detect_edges);
    add_transfers(reader, settings.transfers);
    reader.number("early_packet_delay_us", settings.early_packet_delay_us, 125, 100000);
    reader.flag("verify", settings.verify);
    add_biases(reader, settings.biases, kMost16Bits);
    reader.read();
    return settings;
}

}  // namespace eventide
