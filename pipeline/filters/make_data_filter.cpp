// From "region:10,20,100x50" to a filter.
#include "pipeline/filters/data_filter.h"
#include "pipeline/filters/flicker_filter.h"
#include "pipeline/filters/pixel_filters.h"
#include "pipeline/filters/placing_filters.h"
#include "pipeline/filters/selecting_filters.h"
#include "src/core/duration_text.h"
#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <string_view>

namespace eventide {

namespace {

/// What stands behind the name, and the whole for messages.
struct Arguments {
    std::string_view text;
    const std::string& whole;

    [[noreturn]] void refuse(const std::string& expected) const {
        throw Error(ErrorKind::usage, "filter " + whole + ": expected " + expected + ", found '" +
                                          std::string(text) + "'");
    }
};

/// Splits at the first `separator`; the second part is empty where there is none.
std::pair<std::string_view, std::string_view> split(std::string_view text, std::string_view at) {
    const std::size_t found = text.find(at);
    if (found == text.npos) return {text, {}};
    return {text.substr(0, found), text.substr(found + at.size())};
}

std::optional<int> whole_number(std::string_view text, int least, int most) {
    const auto value = number_in<int>(text);
    return value && *value >= least && *value <= most ? value : std::nullopt;
}

std::optional<SensorDuration> positive_time(std::string_view text) {
    const auto time = read_duration(text);
    return time && time->count() > 0 ? time : std::nullopt;
}

using Made = std::unique_ptr<DataFilter>;

Made make_region(const Arguments& arguments, const SensorPixels& size) {
    const auto [left, after_left] = split(arguments.text, ",");
    const auto [top, extent] = split(after_left, ",");
    const auto [width_text, height_text] = split(extent, "x");
    constexpr int kMax = kLargestSensorSide;
    const auto x = whole_number(left, 0, kMax), y = whole_number(top, 0, kMax),
               width = whole_number(width_text, 1, kMax),
               height = whole_number(height_text, 1, kMax);
    if (!x || !y || !width || !height) arguments.refuse("a region such as 10,20,100x50 (X,Y,WxH)");
    if (*x >= size.width || *y >= size.height)
        arguments.refuse("a region on the sensor of " + std::to_string(size.width) + "x" +
                         std::to_string(size.height));
    return std::make_unique<RegionFilter>(size, *x, *y, *width, *height);
}

Made make_polarity(const Arguments& arguments, const SensorPixels& size) {
    if (arguments.text != "on" && arguments.text != "off") arguments.refuse("on or off");
    return std::make_unique<PolarityFilter>(size, Polarity(arguments.text == "on"));
}

Made make_subsample(const Arguments& arguments, const SensorPixels& size) {
    if (arguments.text.find('x') == arguments.text.npos) {
        const auto n = whole_number(arguments.text, 1, 1'000'000'000);
        if (!n) arguments.refuse("N for each N-th event, or NxM for columns and rows");
        return std::make_unique<EveryNthFilter>(size, std::uint64_t(*n));
    }
    const auto [across, down] = split(arguments.text, "x");
    const auto columns = whole_number(across, 1, size.width),
               rows = whole_number(down, 1, size.height);
    if (!columns || !rows) arguments.refuse("NxM such as 2x2, no more than the sensor has");
    return std::make_unique<ThinningFilter>(size, *columns, *rows);
}

Made make_refractory(const Arguments& arguments, const SensorPixels& size) {
    const auto time = positive_time(arguments.text);
    if (!time) arguments.refuse("a time such as 1ms");
    return std::make_unique<RefractoryFilter>(size, *time);
}

Made make_background_activity(const Arguments& arguments, const SensorPixels& size) {
    const auto [time_text, after_time] = split(arguments.text, ",");
    const auto [radius_text, support_text] = split(after_time, ",");
    const auto time = positive_time(time_text);
    const auto radius =
        radius_text.empty()
            ? std::optional(1)
            : whole_number(radius_text, 1, BackgroundActivityFilter::kLargestRadius);
    const int side = 2 * radius.value_or(1) + 1;
    const auto support =
        support_text.empty() ? std::optional(1) : whole_number(support_text, 1, side * side - 1);
    if (!time || !radius || !support)
        arguments.refuse(
            "a time, and after commas a radius of 1 to 8 px and how many pixels, "
            "such as 10ms,1,2");
    return std::make_unique<BackgroundActivityFilter>(size, *time, *radius, *support);
}

Made make_hot_pixels(const Arguments& arguments, const SensorPixels& size) {
    if (arguments.text.empty()) arguments.refuse("learn or a file");
    if (arguments.text == "learn")
        return std::make_unique<HotPixelDataFilter>(size, HotPixelFilter(size.width, size.height));
    return std::make_unique<HotPixelDataFilter>(
        size, HotPixelFilter(size.width, size.height, std::string(arguments.text)));
}

Made make_flicker(const Arguments& arguments, const SensorPixels& size) {
    constexpr int kLow = FlickerFilter::kLowestHz, kHigh = FlickerFilter::kHighestHz;
    const bool usual = arguments.text.empty();  // lamps, and the screens that flicker
    const auto [from, to] = split(usual ? "50..500" : arguments.text, "..");
    const auto low = whole_number(from, kLow, kHigh), high = whole_number(to, kLow, kHigh);
    if (!low || !high || *low >= *high)
        arguments.refuse("nothing, or LOW..HIGH in Hz, such as 80..130");
    return std::make_unique<FlickerFilter>(size, *low, *high);
}

Made make_flip(const Arguments& arguments, const SensorPixels& size) {
    if (arguments.text != "x" && arguments.text != "y")
        arguments.refuse("x (left to right) or y (upside down)");
    return std::make_unique<FlipFilter>(size, arguments.text == "x");
}

Made make_transpose(const Arguments& arguments, const SensorPixels& size) {
    if (!arguments.text.empty()) arguments.refuse("nothing behind its name");
    return std::make_unique<TransposeFilter>(size);
}

std::optional<TimeFilter::TimePoint> time_point_of(std::string_view text,
                                                   const Arguments& arguments) {
    constexpr const char* kExpected =
        "times such as 1s..2.5s after the first event, or @US..@US of the sensor";
    if (text.empty()) return {};
    if (!text.starts_with('@')) {
        const auto time = read_duration(text);
        if (!time || time->count() < 0) arguments.refuse(kExpected);
        return TimeFilter::TimePoint{false, *time};
    }
    const auto us = number_in<std::int64_t>(text.substr(1));
    if (!us) arguments.refuse(kExpected);
    return TimeFilter::TimePoint{true, SensorDuration{*us}};
}

Made make_time(const Arguments& arguments, const SensorPixels& size) {
    const auto [from, to] = split(arguments.text, "..");
    if (arguments.text.find("..") == arguments.text.npos)
        arguments.refuse("FROM..TO, such as 1s..2.5s");
    const auto begin = time_point_of(from, arguments), end = time_point_of(to, arguments);
    if (begin && end && begin->absolute == end->absolute && end->value < begin->value)
        arguments.refuse("FROM before TO");
    return std::make_unique<TimeFilter>(size, begin, end);
}

struct KnownFilter {
    std::string_view name, arguments;  // in brackets, with the colon, where they may be left out
    Made (*make)(const Arguments&, const SensorPixels&);
};

constexpr KnownFilter kFilters[]{
    {"region", "X,Y,WxH", make_region},
    {"polarity", "on|off", make_polarity},
    {"subsample", "N|NxM", make_subsample},
    {"refractory", "TIME", make_refractory},
    {"background-activity", "TIME[,R[,N]]", make_background_activity},
    {"hot-pixels", "learn|FILE", make_hot_pixels},
    {"flicker", "[:LOW..HIGH]", make_flicker},
    {"flip", "x|y", make_flip},
    {"transpose", "", make_transpose},
    {"time", "FROM..TO", make_time},
};

}  // namespace

std::string data_filter_names() {
    return list_of(kFilters, [](const KnownFilter& filter) {
        const bool has_colon = !filter.arguments.empty() && filter.arguments[0] != '[';
        return std::string(filter.name) + (has_colon ? ":" : "") + std::string(filter.arguments);
    });
}

std::unique_ptr<DataFilter> make_data_filter(const std::string& text, const SensorPixels& size) {
    const auto [name, arguments] = split(text, ":");
    const auto known = std::ranges::find(kFilters, name, &KnownFilter::name);
    if (known == std::end(kFilters))
        throw Error(ErrorKind::usage,
                    "filter: expected one of " + data_filter_names() + "; found '" + text + "'");
    return known->make({arguments, text}, size);
}

}  // namespace eventide
