// Text into values, with complaints that say what was expected and what was found.
#pragma once

#include "src/core/sensor_time.h"
#include "src/core/words.h"

#include <string>
#include <vector>

namespace eventide {

// All throw Error (usage): "expected ..., found '...'".

int parse_whole(const std::string& text, int least, int most);
double parse_number(const std::string& text, double least, double most);

/// A short text that reads back as the same number, in digits where that is possible.
std::string show_number(double value);

/// `text`, which is one of `names`.
const std::string& parse_choice(const std::string& text, const std::vector<std::string>& names);

/// "250us", "20ms" or "1.5s", exact to the microsecond. A number without a unit is refused: to some
/// it means seconds, to others microseconds. Negative ones pass where `negative` says so.
SensorDuration parse_duration(const std::string& text, bool negative = false);
std::string show_duration(SensorDuration duration);

struct Size {
    int width = 0, height = 0;  ///< px
    friend bool operator==(const Size&, const Size&) = default;
};

/// "640x480"; each from 1 to 16384.
Size parse_size(const std::string& text);
std::string show_size(const Size& size);

[[noreturn]] void throw_usage(const std::string& expected, const std::string& found);

}  // namespace eventide
