#include "drivers/usb/usb_settings.h"

#include "drivers/settings_file.h"

#include <array>
#include <string_view>
#include <utility>

namespace eventide {

void require_inside(const SensorRegion& region, const char* name, int width, int height) {
    if (region.x + region.width <= width && region.y + region.height <= height) return;
    throw Error(ErrorKind::usage, std::string{"camera settings: "} + name + " reaches to " +
                                      std::to_string(region.x + region.width) + "," +
                                      std::to_string(region.y + region.height) +
                                      ", this sensor has " + std::to_string(width) + "x" +
                                      std::to_string(height) + " pixels");
}

void add_region(SettingsFile& file, const char* name, std::optional<SensorRegion>& into) {
    constexpr int kMax = 1024;
    file.custom(name, [&file, name, &into](const toml::node& node) {
        const toml::array* numbers = node.as_array();
        if (numbers == nullptr || numbers->size() != 4)
            file.refuse(node, std::string{name} + ": expected [x, y, width, height]");
        std::array<int, 4> region{};
        for (std::size_t i = 0; i < 4; ++i)
            region[i] = int(file.checked(*numbers->get(i), name, i < 2 ? 0 : 1, kMax));
        into = {region[0], region[1], region[2], region[3]};
    });
}

void add_polarity(SettingsFile& file, const char* name, SentPolarity& into) {
    static constexpr std::pair<SentPolarity, std::string_view> kWords[]{
        {SentPolarity::both, "both"},
        {SentPolarity::on, "on"},
        {SentPolarity::off, "off"},
        {SentPolarity::flat, "flat"}};
    file.custom(name, [&file, name, &into](const toml::node& node) {
        const auto text = node.value_exact<std::string>();
        for (const auto& [polarity, word] : kWords)
            if (text && *text == word) {
                into = polarity;
                return;
            }
        file.refuse(node, std::string{name} + ": expected \"both\", \"on\", \"off\" or \"flat\"");
    });
}

void add_transfers(SettingsFile& file, UsbStreamSettings& into) {
    file.number("transfers", into.transfers, 2, 256);
    file.custom("transfer_kib", [&file, &into](const toml::node& node) {
        into.bytes = std::size_t(file.checked(node, "transfer_kib", 1, 4096)) * 1024;
    });
}

void add_biases(SettingsFile& file, std::map<std::string, std::uint32_t>& into,
                std::uint32_t most) {
    file.custom("biases", [&file, &into, most](const toml::node& node) {
        const toml::table* biases = node.as_table();
        if (biases == nullptr) file.refuse(node, "biases: expected a table of names and numbers");
        for (const auto& [key, value] : *biases) {
            const std::string name{key.str()};
            into[name] = std::uint32_t(file.checked(value, "biases." + name, 0, most));
        }
    });
}

}  // namespace eventide
