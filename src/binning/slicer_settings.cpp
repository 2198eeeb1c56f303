// What settings mean for a sensor, and "--window": text <-> settings.
#include "src/binning/slicer_settings.h"

#include "src/core/duration_text.h"
#include "src/core/error.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace eventide {
namespace {

constexpr double kUsPerDay = 24.0 * 3600.0 * 1e6;
constexpr double kMaxEvents = 1e9;
/// Images come 5 to 50 times a second; a window between two of them must not be cut in two.
constexpr SensorDuration kReferenceMaxWidth{1'000'000};
/// Rule content (docs/accuracy.md, "Windows by content").
constexpr SensorDuration kContentMaxWidth{100'000};
constexpr double kContentEventsPerPixel = 0.4;

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
    throw Error(
        ErrorKind::usage,
        "window '" + std::string{text} + "': " + why +
            "; expected for example auto, 50ms, 20000ev, 0.35epp, aps, or with a maximum width "
            "20000ev,200ms, or with a minimum, too, auto,50ms,5ms");
}

void require(bool good, const char* name, std::int64_t found) {
    if (!good)
        throw Error(ErrorKind::usage, std::string{"event windows: "} + name +
                                          " must be at least 1, found " + std::to_string(found));
}

struct Quantity {
    double value;
    std::string_view unit;
};

Quantity quantity(std::string_view part, std::string_view text) {
    const auto value = take_number<double>(part);
    if (!value) refuse(text, "no number");
    return {*value, part};
}

std::optional<SensorDuration> duration(Quantity q, std::string_view text) {
    const double us_per_unit = q.unit == "us"   ? 1.0
                               : q.unit == "ms" ? 1e3
                               : q.unit == "s"  ? 1e6
                                                : 0.0;
    if (us_per_unit == 0.0) return std::nullopt;
    const double us = std::round(q.value * us_per_unit);
    if (us < 1 || us > kUsPerDay) refuse(text, "a width is 1 us to one day");
    return SensorDuration{std::int64_t(us)};
}

SensorDuration width(std::string_view part, std::string_view text, const std::string& which) {
    const auto found = duration(quantity(part, text), text);
    if (!found) refuse(text, "the " + which + " width is a duration");
    return *found;
}

void parse_rule(std::string_view rule, std::string_view text, SlicerSettings& settings) {
    if (rule == "aps") {
        settings.rule = WindowRule::reference;
        settings.max_width = kReferenceMaxWidth;
        return;
    }
    if (rule == "auto") {
        settings.rule = WindowRule::content;
        settings.events_per_pixel = kContentEventsPerPixel;
        settings.max_width = kContentMaxWidth;
        return;
    }
    const Quantity q = quantity(rule, text);
    if (q.unit == "ev") {
        settings.rule = WindowRule::count;
        if (q.value < 1 || q.value > kMaxEvents || q.value != std::floor(q.value))
            refuse(text, "a number of events is a whole number from 1 to 1e9");
        settings.events = std::uint64_t(q.value);
    } else if (q.unit == "epp") {
        settings.rule = WindowRule::count;
        if (q.value <= 0 || q.value > 1000)
            refuse(text, "events per pixel are more than 0 and at most 1000");
        settings.events_per_pixel = q.value;
    } else if (const auto width = duration(q, text)) {
        settings.rule = WindowRule::duration;
        settings.width = *width;
    } else if (q.unit.empty()) {
        const std::string number{rule};
        refuse(text, "expected a unit, as in " + number + "s, " + number + "ms, " + number +
                         "us or " + number + "ev");
    } else {
        refuse(text, "unknown unit '" + std::string{q.unit} + "'");
    }
}

}  // namespace

void check_slicer_settings(const SlicerSettings& settings, int width, int height) {
    require(width >= 1 && height >= 1, "the sensor's size", std::min(width, height));
    const SensorDuration widest = natural_width(settings);
    require(widest >= SensorDuration{1}, "the (maximum) width in us", widest.count());
    const std::uint64_t events = events_per_window(settings, width, height);
    require(events >= 1, "the number of events", std::int64_t(events));
    require(settings.silent_windows >= 1, "silent_windows", settings.silent_windows);
}

SensorDuration natural_width(const SlicerSettings& settings) {
    return settings.rule == WindowRule::duration ? settings.width : settings.max_width;
}

std::uint64_t events_per_window(const SlicerSettings& settings, int width, int height) {
    if (settings.rule != WindowRule::count) return settings.max_events;
    const double pixels = double(width) * double(height);
    const std::uint64_t wanted =
        settings.events_per_pixel > 0
            ? std::uint64_t(std::llround(std::max(1.0, settings.events_per_pixel * pixels)))
            : settings.events;
    return std::min(wanted, settings.max_events);
}

SlicerSettings parse_window(std::string_view text) {
    SlicerSettings settings;
    const auto comma = text.find(',');
    parse_rule(text.substr(0, comma), text, settings);
    if (comma == text.npos) return settings;
    if (settings.rule == WindowRule::duration) refuse(text, "a constant width has no maximum");
    const auto second = text.find(',', comma + 1);
    settings.max_width = width(text.substr(comma + 1, second - comma - 1), text, "maximum");
    if (second != text.npos) {
        if (settings.rule != WindowRule::content) refuse(text, "only auto has a minimum width");
        settings.min_width = width(text.substr(second + 1), text, "minimum");
    }
    if (settings.rule == WindowRule::content && settings.min_width > settings.max_width)
        refuse(text, "the minimum width, " + duration_text(settings.min_width) +
                         (second == text.npos ? " where none is given" : "") +
                         ", exceeds the maximum");
    return settings;
}

std::string window_text(const SlicerSettings& settings) {
    const std::string widest = "," + duration_text(settings.max_width);
    switch (settings.rule) {
        case WindowRule::duration:
            return duration_text(settings.width);
        case WindowRule::reference:
            return "aps" + widest;
        case WindowRule::content:
            return "auto" + widest +
                   (settings.min_width == SlicerSettings{}.min_width
                        ? ""
                        : "," + duration_text(settings.min_width));
        case WindowRule::count:
            break;
    }
    if (settings.events_per_pixel <= 0) return std::to_string(settings.events) + "ev" + widest;
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, settings.events_per_pixel).ptr;
    return std::string{digits, end} + "epp" + widest;
}

}  // namespace eventide
