// config/cameras/*.toml -> V4l2Settings.
#include "drivers/settings_file.h"
#include "drivers/v4l2/bias_file.h"
#include "drivers/v4l2/v4l2_camera.h"
#include "src/core/error.h"
#include "src/core/sensor_limits.h"

#include <string>

namespace eventide {

namespace {

void add_biases(const std::filesystem::path& file, V4l2Settings& settings) {
    for (const BiasLine& bias : read_bias_file(file)) {
        if (const auto other = settings.control_places.find(bias.name);
            other != settings.control_places.end())
            throw Error(ErrorKind::usage, bias.place + ": '" + bias.name + "' is also in " +
                                              other->second + "; expected it in one place");
        settings.controls[bias.name] = bias.value;
        settings.control_places[bias.name] = bias.place;
    }
}

Setting encoding_setting(V4l2Settings& settings) {
    return choice_setting("encoding", settings.encoding, "",
                          {{EvtEncoding::evt2, "evt2"},
                           {EvtEncoding::evt21, "evt21"},
                           {EvtEncoding::evt21_swapped, "evt21_swapped"},
                           {EvtEncoding::evt3, "evt3"}});
}

Setting size_setting(V4l2Settings& settings) {
    return file_setting("size", [&settings](const SettingValue& value) {
        if (value.kind != ValueKind::list || value.items.size() != 2)
            value.refuse("[width, height]");
        settings.width = int(whole_of(value.items[0], 1, kLargestSensorSide));
        settings.height = int(whole_of(value.items[1], 1, kLargestSensorSide));
    });
}

Setting subdevice_setting(V4l2Settings& settings) {
    return file_setting("subdevice", [&settings](const SettingValue& value) {
        if (value.kind != ValueKind::text) value.refuse("a path such as \"/dev/v4l-subdev0\"");
        settings.subdevice = value.text;
    });
}

Setting controls_setting(V4l2Settings& settings) {
    return file_setting("controls", [&settings](const SettingValue& value) {
        if (value.kind != ValueKind::table) value.refuse("a table of names and whole numbers");
        for (const SettingValue& control : value.items) {
            settings.controls[control.key] = whole_of(control, INT32_MIN, INT32_MAX);
            settings.control_places[control.key] = control.place;
        }
    });
}

Setting biases_setting(const std::filesystem::path& file, std::filesystem::path& biases) {
    return file_setting("biases", [&file, &biases](const SettingValue& value) {
        if (value.kind != ValueKind::text || !names_bias_file(value.text))
            value.refuse("a file such as \"imx636.bias\" or \"settings.json\"");
        biases = file.parent_path() / value.text;
    });
}

}  // namespace

V4l2Settings load_v4l2_settings(const std::filesystem::path& file) {
    V4l2Settings settings;
    if (names_bias_file(file)) {
        add_biases(file, settings);
        return settings;
    }
    std::filesystem::path biases;
    read_camera_settings(
        file, {encoding_setting(settings), size_setting(settings), subdevice_setting(settings),
               controls_setting(settings), biases_setting(file, biases),
               whole_setting("buffers", settings.buffers, 2, 256)});
    if (!biases.empty()) add_biases(biases, settings);
    return settings;
}

}  // namespace eventide
