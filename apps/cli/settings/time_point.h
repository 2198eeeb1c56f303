// Times of a recording, as users say them: after its first event, or in the sensor's own time.
#pragma once

#include "replay/open_options.h"
#include "src/core/sensor_time.h"
#include "src/settings/setting.h"

#include <optional>
#include <string>

namespace eventide::app {

/// "2.5s" or "20ms" after the first event, or "@1633953690975951", the sensor's microseconds.
struct TimePoint {
    bool absolute = false;
    SensorDuration value{};
};

/// Throws Error (usage).
TimePoint parse_time_point(const std::string& text);
std::string show_time_point(const TimePoint& point);

/// `word` stands for an empty value.
Setting time_point_setting(std::string key, std::optional<TimePoint>& value,
                           const std::string& word, std::string help);

/// Standard input and named pipes: what was read is gone.
bool is_read_once(const std::string& path);

/// Knows when a recording begins, once somebody asks.
class TimePointReader {
public:
    TimePointReader(std::string path, OpenOptions options)
        : path_{std::move(path)}, options_{std::move(options)} {}
    /// For a recording whose beginning is known: nothing is read.
    explicit TimePointReader(SensorTime first) : first_{first} {}

    /// Reads the beginning of the recording, through an opening of its own, for the first relative
    /// point. Throws Error: usage for a relative point of what is read once, input where there is
    /// no event.
    SensorTime time_of(const TimePoint& point) const;

private:
    SensorTime first_time() const;

    std::string path_;
    OpenOptions options_;
    mutable std::optional<SensorTime> first_;
};

}  // namespace eventide::app
