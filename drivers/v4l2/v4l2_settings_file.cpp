// config/cameras/*.toml -> V4l2Settings.
#include "drivers/settings_file.h"
#include "drivers/v4l2/bias_file.h"
#include "drivers/v4l2/v4l2_camera.h"

#include <string>

namespace eventide {

namespace {

void add_biases(const std::filesystem::path& file, V4l2Settings& settings) {
    for (const Bias& bias : read_bias_file(file)) {
        if (const auto other = settings.control_places.find(bias.name);
            other != settings.control_places.end())
            throw Error(ErrorKind::usage, bias.place + ": '" + bias.name + "' is also in " +
                                              other->second + "; expected it in one place");
        settings.controls[bias.name] = bias.value;
        settings.control_places[bias.name] = bias.place;
    }
}

}  // namespace

V4l2Settings load_v4l2_settings(const std::filesystem::path& file) {
    V4l2Settings settings;
    if (names_bias_file(file)) {
        add_biases(file, settings);
        return settings;
    }
    std::filesystem::path biases;
    SettingsFile reader{file};
    reader.custom("encoding", [&](const toml::node& node) {
        const std::string name = node.value_or(std::string{});
        if (name == "evt2")
            settings.encoding = EvtEncoding::evt2;
        else if (name == "evt21")
            settings.encoding = EvtEncoding::evt21;
        else if (name == "evt21_swapped")
            settings.encoding = EvtEncoding::evt21_swapped;
        else if (name == "evt3")
            settings.encoding = EvtEncoding::evt3;
        else
            reader.refuse(node,
                          "encoding: expected \"evt2\", \"evt21\", \"evt21_swapped\" or \"evt3\"");
    });
    reader.custom("size", [&](const toml::node& node) {
        const toml::array* numbers = node.as_array();
        if (numbers == nullptr || numbers->size() != 2)
            reader.refuse(node, "size: expected [width, height]");
        settings.width = int(reader.checked(*numbers->get(0), "size", 1, 4096));
        settings.height = int(reader.checked(*numbers->get(1), "size", 1, 4096));
    });
    reader.custom("subdevice", [&](const toml::node& node) {
        const auto path = node.value_exact<std::string>();
        if (!path) reader.refuse(node, "subdevice: expected a path such as \"/dev/v4l-subdev0\"");
        settings.subdevice = *path;
    });
    reader.custom("controls", [&](const toml::node& node) {
        const toml::table* controls = node.as_table();
        if (controls == nullptr)
            reader.refuse(node, "controls: expected a table of names and whole numbers");
        for (const auto& [key, value] : *controls) {
            const std::string name{key.str()};
            settings.controls[name] =
                reader.checked(value, "controls." + name, INT32_MIN, INT32_MAX);
            settings.control_places[name] =
                file.string() + ":" + std::to_string(value.source().begin.line);
        }
    });
    reader.custom("biases", [&](const toml::node& node) {
        const auto path = node.value_exact<std::string>();
        if (!path || !names_bias_file(*path))
            reader.refuse(node,
                          "biases: expected a file such as \"imx636.bias\" or \"settings.json\"");
        biases = file.parent_path() / *path;
    });
    reader.number("buffers", settings.buffers, 2, 256);
    reader.read();
    if (!biases.empty()) add_biases(biases, settings);
    return settings;
}

}  // namespace eventide
