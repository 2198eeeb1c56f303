// config/cameras/*.toml -> DavisSettings.
#include "drivers/settings_file.h"
#include "drivers/usb/davis_settings.h"

#include <array>
#include <string>

namespace eventide {

DavisSettings load_davis_settings(const std::filesystem::path& file) {
    DavisSettings settings;
    SettingsFile reader{file};
    reader.flag("frames", settings.frames);
    reader.flag("global_shutter", settings.global_shutter);
    reader.number("exposure_us", settings.exposure_us, 0, 4194303);
    reader.number("frame_interval_us", settings.frame_interval_us, 0, 8388607);
    reader.flag("auto_exposure", settings.auto_exposure);
    reader.flag("imu", settings.imu);
    reader.choice("accel_range_g", settings.accel_range_g, {2, 4, 8, 16});
    reader.choice("gyro_range_dps", settings.gyro_range_dps, {250, 500, 1000, 2000});
    reader.flag("activity_filter", settings.activity_filter);
    reader.number("activity_time_us", settings.activity_time_us, 250, 1000000);
    reader.number("skip_every", settings.skip_every, 0, 255);
    reader.flag("detect_pulses", settings.detect_pulses);
    reader.flag("detect_edges", settings.detect_edges);
    reader.number("transfers", settings.transfers.transfers, 2, 256);
    reader.number("early_packet_delay_us", settings.early_packet_delay_us, 125, 100000);
    int transfer_kib = int(settings.transfers.bytes / 1024);
    reader.number("transfer_kib", transfer_kib, 1, 4096);
    reader.custom("roi", [&](const toml::node& node) {
        const toml::array* numbers = node.as_array();
        if (numbers == nullptr || numbers->size() != 4)
            reader.refuse(node, "roi: expected [x, y, width, height]");
        std::array<int, 4> roi{};
        for (std::size_t i = 0; i < 4; ++i)
            roi[i] = int(reader.checked(*numbers->get(i), "roi", i < 2 ? 0 : 1, 1023));
        settings.roi = {roi[0], roi[1], roi[2], roi[3]};
    });
    reader.custom("biases", [&](const toml::node& node) {
        const toml::table* biases = node.as_table();
        if (biases == nullptr)
            reader.refuse(node, "biases: expected a table of names and 16-bit words");
        for (const auto& [name, value] : *biases)
            settings.biases[std::string{name.str()}] = std::uint16_t(
                reader.checked(value, "biases." + std::string{name.str()}, 0, 0xFFFF));
    });
    reader.read();
    settings.transfers.bytes = std::size_t(transfer_kib) * 1024;
    return settings;
}

}  // namespace eventide
