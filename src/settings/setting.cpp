// Names of settings, and the kinds most of them are.
#include "src/settings/setting.h"

#include "src/core/error.h"

#include <algorithm>
#include <cctype>

namespace eventide {

std::string help_with_default(const Setting& setting) {
    std::string value;
    if (setting.kind != ValueKind::flag)
        for (const std::string& text : setting.show()) value += (value.empty() ? "" : " ") + text;
    return setting.help + (value.empty() ? "" : " [" + value + "]");
}

std::string flag_of(const Setting& setting) {
    std::string flag = "--" + setting.key;
    std::ranges::replace(flag, '_', '-');
    return flag;
}

std::string environment_of(const SettingTable& table, const Setting& setting) {
    std::string name =
        "EVENTIDE_" + (table.section.empty() ? "" : table.section + "_") + setting.key;
    std::ranges::transform(name, name.begin(),
                           [](unsigned char c) { return char(std::toupper(c)); });
    return name;
}

void SettingTable::group_rest(const std::string& heading) {
    for (Setting& setting : settings)
        if (setting.group.empty()) setting.group = heading;
}

void set_from(const std::string& origin, const Setting& setting, const SettingValue& value) {
    try {
        setting.set(value);
    } catch (const Error& error) {
        throw Error(error.kind(), origin + ": " + error.what());
    }
}

Setting noted(Setting setting, bool& given) {
    setting.set = [set = std::move(setting.set), &given](const SettingValue& value) {
        set(value);
        given = true;
    };
    return setting;
}

std::string same_text(const std::string& text) {
    return text;
}

Setting text_setting(std::string key, std::string& value, std::string value_name,
                     std::string help) {
    return parsed_setting<std::string>(std::move(key), value, std::move(value_name),
                                       std::move(help), same_text, same_text);
}

Setting path_setting(std::string key, std::string& value, std::string value_name,
                     std::string help) {
    Setting setting = text_setting(std::move(key), value, std::move(value_name), std::move(help));
    setting.names_file = true;
    return setting;
}

Setting file_setting(std::string key, std::function<void(const SettingValue&)> set) {
    return {std::move(key), {}, {}, {}, {}, {}, std::move(set), {}};
}

Setting flag_setting(std::string key, bool& value, std::string help) {
    Setting setting{std::move(key), ValueKind::flag, "", std::move(help), {}, {}, {}, {}};
    setting.set = [&value](const SettingValue& given) {
        if (!given.may_be(ValueKind::flag) || (given.text != "true" && given.text != "false"))
            given.refuse("true or false");
        value = given.text == "true";
    };
    setting.show = [&value] { return std::vector<std::string>{value ? "true" : "false"}; };
    return setting;
}

Setting list_setting(std::string key, std::vector<std::string>& value, std::string value_name,
                     std::string help) {
    Setting setting{
        std::move(key), ValueKind::list, std::move(value_name), std::move(help), {}, {}, {}, {}};
    setting.set = [&value](const SettingValue& given) { value = given.texts(); };
    setting.show = [&value] { return value; };
    return setting;
}

Setting whole_setting(std::string key, int& value, std::string value_name, std::string help,
                      int least, int most) {
    Setting setting{
        std::move(key), ValueKind::number, std::move(value_name), std::move(help), {}, {}, {}, {}};
    setting.set = [&value, least, most](const SettingValue& given) {
        value = int(whole_of(given, least, most));
    };
    setting.show = [&value] { return std::vector{std::to_string(value)}; };
    return setting;
}

Setting whole_setting(std::string key, int& value, int least, int most) {
    return whole_setting(std::move(key), value, {}, {}, least, most);
}

Setting number_setting(std::string key, double& value, std::string value_name, std::string help,
                       double least, double most) {
    Setting setting = parsed_setting<double>(
        std::move(key), value, std::move(value_name), std::move(help),
        [least, most](const std::string& text) { return parse_number(text, least, most); },
        [](const double& v) { return show_number(v); });
    setting.kind = ValueKind::number;
    return setting;
}

}  // namespace eventide
