#include "drivers/usb/usb_settings.h"

#include "src/core/error.h"

#include <array>

namespace eventide {

void require_inside(const SensorRegion& region, const char* name, int width, int height) {
    if (region.x + region.width <= width && region.y + region.height <= height) return;
    throw Error(ErrorKind::usage, std::string{"camera settings: "} + name + " reaches to " +
                                      std::to_string(region.x + region.width) + "," +
                                      std::to_string(region.y + region.height) +
                                      ", this sensor has " + std::to_string(width) + "x" +
                                      std::to_string(height) + " pixels");
}

Setting region_setting(const char* key, std::optional<SensorRegion>& into) {
    constexpr int kMax = 1024;
    return file_setting(key, [&into](const SettingValue& value) {
        if (value.kind != ValueKind::list || value.items.size() != 4)
            value.refuse("[x, y, width, height]");
        std::array<int, 4> region{};
        for (std::size_t i = 0; i < 4; ++i)
            region[i] = int(whole_of(value.items[i], i < 2 ? 0 : 1, kMax));
        into = {region[0], region[1], region[2], region[3]};
    });
}

Setting polarity_setting(SentPolarity& into) {
    return choice_setting("polarity", into, "",
                          {{SentPolarity::both, "both"},
                           {SentPolarity::on, "on"},
                           {SentPolarity::off, "off"},
                           {SentPolarity::flat, "flat"}});
}

Setting transfers_setting(UsbStreamSettings& into) {
    return whole_setting("transfers", into.transfers, 2, 256);
}

Setting transfer_size_setting(UsbStreamSettings& into) {
    return file_setting("transfer_kib", [&into](const SettingValue& value) {
        into.bytes = std::size_t(whole_of(value, 1, 4096)) * 1024;
    });
}

Setting biases_setting(std::map<std::string, std::uint32_t>& into, std::uint32_t most) {
    return file_setting("biases", [&into, most](const SettingValue& value) {
        if (value.kind != ValueKind::table) value.refuse("a table of names and numbers");
        for (const SettingValue& bias : value.items)
            into[bias.key] = std::uint32_t(whole_of(bias, 0, most));
    });
}

}  // namespace eventide
