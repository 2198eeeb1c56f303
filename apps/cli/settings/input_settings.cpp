// What the user may say about an input.
#include "apps/cli/settings/input_settings.h"

#include "apps/cli/idle_flag.h"
#include "drivers/devices.h"
#include "pipeline/filters/data_filter.h"
#include "replay/formats.h"
#include "src/core/error.h"
#include "src/core/list_text.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

namespace eventide::app {

namespace {

/// Empty where the user says "auto".
Setting text_or_auto(std::string key, std::string& value, std::string argument, std::string help) {
    return parsed_setting<std::string>(
        std::move(key), value, std::move(argument), std::move(help),
        [](const std::string& text) { return text == "auto" ? std::string{} : text; },
        [](const std::string& text) { return text.empty() ? "auto" : text; });
}

/// What only some formats leave open.
struct InputFlag {
    const char* key;
    std::vector<std::string_view> formats;
};

}  // namespace

void InputSettings::add_to(SettingTable& table) {
    table.settings.push_back(parsed_setting<std::string>(
        "input_format", open.format, "FORMAT",
        "Format of the recording: auto (by its content), " + list_of(all_formats(), &Format::name) +
            ".",
        [](const std::string& text) {
            if (text == "auto") return std::string{};
            if (find_format(text) == nullptr)
                throw_usage("auto, " + list_of(all_formats(), &Format::name), text);
            return text;
        },
        [](const std::string& text) { return text.empty() ? "auto" : text; }));
    table.settings.push_back(parsed_setting<std::optional<Size>>(
        "input_size", size, "WxH",
        "Size of the sensor in pixels, such as 240x180, for recordings that do not say it; auto "
        "takes what the recording says.",
        [](const std::string& text) {
            return text == "auto" ? std::nullopt : std::optional{parse_size(text)};
        },
        [](const std::optional<Size>& s) { return s ? show_size(*s) : "auto"; }));
    table.settings.push_back(text_or_auto(
        "input_stream", open.stream, "NAME",
        "Whose events are read, of a recording with those of several cameras: a bag's topic, "
        "davis/right of an HDF5 file, the number of an AEDAT 3 source or AEDAT 4 stream, as "
        "eventide info names them; auto takes the first."));
    table.settings.push_back(text_or_auto(
        "input_columns", open.text.columns, "ORDER",
        "Columns of a text recording, such as txyp or xypt; auto takes them from a header row, or "
        "from the numbers themselves."));
    table.settings.push_back(choice_setting(
        "input_time_unit", open.text.unit,
        "Unit of the times in a text recording; auto: seconds where there are fractions, else "
        "microseconds, or what gives a plausible rate of events.",
        {{TextTimeUnit::automatic, "auto"},
         {TextTimeUnit::seconds, "s"},
         {TextTimeUnit::milliseconds, "ms"},
         {TextTimeUnit::microseconds, "us"},
         {TextTimeUnit::nanoseconds, "ns"}}));
    table.settings.push_back(parsed_setting<SensorDuration>(
        "reorder", open.text.reorder, "TIME",
        "Sort rows of a text recording that come at most this much too late; 0s takes them as they "
        "come. Rows that come later still are left out.",
        [](const std::string& text) { return parse_duration(text); },
        [](const SensorDuration& d) { return show_duration(d); }));
    table.settings.push_back(flag_setting(
        "input_dvs128_one_is_on", open.dvs128_one_is_on,
        "In AEDAT 1.0 and 2.0 files of a DVS128, polarity bit 1 means on; jAER's files, the usual "
        "ones, have it the other way round."));
}

OpenOptions InputSettings::options() const {
    OpenOptions options = open;
    if (size) {
        options.width = size->width;
        options.height = size->height;
    }
    return options;
}

void refuse_idle_input_flags(const FlagKeys& flags, const std::vector<std::string>& formats) {
    static const InputFlag kInputFlags[]{{"input_columns", {"text", "npy", "npz"}},
                                         {"input_time_unit", {"text", "npy", "npz"}},
                                         {"reorder", {"text"}},
                                         {"input_dvs128_one_is_on", {"aedat1", "aedat2"}}};
    for (const InputFlag& flag : kInputFlags) {
        const auto leaves_open = [&](const std::string& format) {
            return std::ranges::find(flag.formats, format) != flag.formats.end();
        };
        if (std::ranges::any_of(formats, leaves_open)) continue;
        refuse_idle_flag(
            flags, flag.key,
            "a recording in the format " + alternatives({flag.formats.begin(), flag.formats.end()}),
            formats.front());
    }
}

Setting filter_setting(std::vector<std::string>& filters) {
    return list_setting("filter", filters, "NAME:ARGS",
                        "Filter the events; several filters apply in the order given. One of " +
                            data_filter_names() + ".");
}

void refuse_camera(const std::string& path) {
    if (!names_device_alone(path)) return;
    throw Error(ErrorKind::usage,
                "'" + path + "': expected a recording, found the name of a " +
                    (names_camera(path)
                         ? "camera; eventide run " + path + " --record FILE makes a recording of it"
                         : "simulation; eventide simulate makes a recording"));
}

std::unique_ptr<Recording> open_input(const std::string& path, const InputSettings& input,
                                      std::function<bool()> give_up) {
    refuse_camera(path);
    OpenOptions options = input.options();
    options.give_up = std::move(give_up);
    auto recording = open_recording(path, options);
    for (const std::string& remark : recording->remarks()) spdlog::warn("{}: {}", path, remark);
    return recording;
}

}  // namespace eventide::app
