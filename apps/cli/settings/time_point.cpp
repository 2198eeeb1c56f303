// Times of a recording, as users say them.
#include "apps/cli/settings/time_point.h"

#include "replay/formats.h"
#include "replay/summary.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"
#include "src/io/stream_name.h"

#include <filesystem>
#include <system_error>

namespace eventide::app {

TimePoint parse_time_point(const std::string& text) {
    if (!text.starts_with('@')) return {false, parse_duration(text)};
    const auto us = number_in<std::int64_t>(std::string_view{text}.substr(1));
    if (!us || *us < -kFarthestUs || *us > kFarthestUs)
        throw_usage("@ and microseconds, at most " + std::to_string(kFarthestUs) + " from zero",
                    text);
    return {true, SensorDuration{*us}};
}

std::string show_time_point(const TimePoint& point) {
    return point.absolute ? "@" + std::to_string(point.value.count()) : show_duration(point.value);
}

Setting time_point_setting(std::string key, std::optional<TimePoint>& value,
                           const std::string& word, std::string help) {
    return parsed_setting<std::optional<TimePoint>>(
        std::move(key), value, "TIME", std::move(help),
        [word](const std::string& text) {
            return text == word ? std::nullopt : std::optional{parse_time_point(text)};
        },
        [word](const std::optional<TimePoint>& point) {
            return point ? show_time_point(*point) : word;
        });
}

SensorTime TimePointReader::time_of(const TimePoint& point) const {
    if (point.absolute) return SensorTime{point.value};
    if (!first_) first_ = first_time();
    return *first_ + point.value;
}

bool is_read_once(const std::string& path) {
    std::error_code none;
    return path == "-" || std::filesystem::is_other(path, none);
}

SensorTime TimePointReader::first_time() const {
    if (is_read_once(path_))
        throw Error(ErrorKind::usage,
                    input_name(path_) +
                        " cannot be read twice to find its first event; expected times as "
                        "@MICROSECONDS of the sensor");
    const auto recording = open_recording(path_, options_);
    const auto first = first_event_time(*recording);
    if (!first) throw Error(ErrorKind::input, path_ + ": there is no event to count times from");
    return *first;
}

}  // namespace eventide::app
