#include "drivers/settings_file.h"

#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/settings/suggestion.h"

#include <algorithm>

namespace eventide {

void read_camera_settings(const std::filesystem::path& file, const std::vector<Setting>& settings) {
    std::error_code none;
    if (!std::filesystem::is_regular_file(file, none))
        throw Error(ErrorKind::usage, "camera settings '" + file.string() + "': no such file");
    if (file.extension() == ".bias")
        throw Error(ErrorKind::usage, "camera settings '" + file.string() +
                                          "': expected TOML as in config/cameras, found a .bias "
                                          "file of Prophesee's, which is for v4l2: cameras");
    std::vector<std::string> known;
    known.reserve(settings.size());
    for (const Setting& setting : settings) known.push_back(setting.key);
    for (const SettingValue& value : read_settings_file(file).items) {
        const auto setting = std::ranges::find(settings, value.key, &Setting::key);
        if (setting == settings.end())
            throw Error(ErrorKind::usage, value.place + ": unknown key '" + value.key + "'" +
                                              suggestion(value.key, known));
        setting->set(value);
    }
}

Setting one_of_setting(std::string key, int& into, std::vector<int> allowed) {
    return file_setting(
        std::move(key), [&into, all = std::move(allowed)](const SettingValue& value) {
            for (const int a : all)
                if (value.kind == ValueKind::number && value.text == std::to_string(a)) {
                    into = a;
                    return;
                }
            value.refuse("one of " + list_of(all, [](int a) { return std::to_string(a); }));
        });
}

}  // namespace eventide
