// Keys of RAW headers through the years (docs/protocols.md D.4).
#include "src/codec/prophesee/evt_header.h"

#include "src/codec/prophesee/evt_systems.h"
#include "src/core/error.h"
#include "src/core/number_text.h"
#include "src/core/sensor_limits.h"

#include <algorithm>
#include <array>

namespace eventide {

namespace {

constexpr std::size_t kLongestLine = 4096;

bool is_text(char c) {
    return c == '\t' || c == '\r' || c < 0 || c >= ' ';
}

int side(std::string_view text) {
    const int px = number_in<int>(text).value_or(0);
    return px > 0 && px <= kLargestRecordedSide ? px : 0;
}

/// "EVT3;height=720;width=1280"
std::string_view option_of(std::string_view format, std::string_view key) {
    for (std::size_t at = 0; at < format.size();) {
        const std::size_t end = std::min(format.find(';', at), format.size());
        const std::string_view option = format.substr(at, end - at);
        if (option.starts_with(key) && option.substr(key.size()).starts_with('='))
            return option.substr(key.size() + 1);
        at = end + 1;
    }
    return {};
}

/// Files from before 2023 name one integrator for camera and plugin, older ones none.
bool is_of_prophesee(const PercentLines& lines) {
    constexpr std::array kKeys{"plugin_integrator_name", "camera_integrator_name",
                               "integrator_name"};
    return std::all_of(kKeys.begin(), kKeys.end(), [&](std::string_view key) {
        const std::string_view name = lines.value(key);
        return name.empty() || name == "Prophesee";
    });
}

int system_of(const PercentLines& lines) {
    return number_in<int>(lines.value("system_ID")).value_or(0);
}

/// Null where it is unknown, or another maker's.
const EvtSystem* known_system(const PercentLines& lines) {
    return is_of_prophesee(lines) ? find_evt_system(system_of(lines)) : nullptr;
}

std::string_view format_name(const PercentLines& lines) {
    const std::string_view format = lines.value("format"), version = lines.value("evt");
    const std::string_view name = format.substr(0, format.find(';'));
    if (name == "EVT2" || version == "2.0") return "evt2";
    if (name == "EVT21" || name == "EVT2.1" || version == "2.1") return "evt21";
    if (name == "EVT3" || version == "3.0") return "evt3";
    const EvtSystem* const system = known_system(lines);
    return system != nullptr && format.empty() && version.empty() ? system->format
                                                                  : std::string_view{};
}

void find_size(const PercentLines& lines, StreamHeader& stream) {
    const std::string_view format = lines.value("format"), geometry = lines.value("geometry");
    stream.width = side(option_of(format, "width"));
    stream.height = side(option_of(format, "height"));
    const std::size_t cross = geometry.find('x');
    if (cross != std::string_view::npos && (stream.width == 0 || stream.height == 0)) {
        stream.width = side(geometry.substr(0, cross));
        stream.height = side(geometry.substr(cross + 1));
    }
    if (stream.width > 0 && stream.height > 0) return;
    // Before 2021 only the system's number, or the name of its plugin, tells the sensor.
    const EvtSystem* const system = known_system(lines);
    const std::string_view plugin = lines.value("plugin_name");
    const auto named = [&](std::string_view sensor) {
        return plugin.find(sensor) != std::string_view::npos;
    };
    stream.width = stream.height = 0;
    if (system != nullptr) {
        stream.width = system->width;
        stream.height = system->height;
    } else if (named("gen4") || named("imx636")) {
        stream.width = 1280;
        stream.height = 720;
    } else if (named("gen3")) {
        stream.width = 640;
        stream.height = 480;
    } else if (named("genx320")) {
        stream.width = stream.height = 320;
    }
}

/// Of EVT2.1: systems before number 0x37 swapped the halves and did not say it (OpenEB,
/// psee_raw_file_header.cpp, check_header()).
bool are_halves_swapped(const PercentLines& lines) {
    constexpr int kFirstInOrder = 0x37;
    for (const std::string_view stated :
         {option_of(lines.value("format"), "endianness"), lines.value("endianness")})
        if (!stated.empty()) return stated == "legacy";
    const int system = system_of(lines);
    return is_of_prophesee(lines) && system > 0 && system < kFirstInOrder;
}

std::string sensor_name(const PercentLines& lines) {
    // The second is of files that eventide wrote earlier.
    for (const std::string_view key : {"sensor_name", "camera_integration_name"})
        if (const auto name = lines.value(key); !name.empty()) return std::string(name);
    const std::string_view generation = lines.value("sensor_generation");
    if (generation == "4.2") return "IMX636";
    if (!generation.empty()) return "Gen" + std::string(generation);
    const EvtSystem* const system = known_system(lines);
    return std::string(system != nullptr ? system->sensor : lines.value("system_ID"));
}

}  // namespace

std::string_view PercentLines::value(std::string_view key) const {
    const auto found =
        std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == key; });
    return found == values.end() ? std::string_view{} : std::string_view(found->second);
}

PercentLines read_percent_lines(std::span<const std::byte> first_bytes) {
    PercentLines lines;
    std::string_view text(reinterpret_cast<const char*>(first_bytes.data()), first_bytes.size());
    while (text.starts_with("% ")) {
        const std::size_t end = text.substr(0, kLongestLine).find('\n');
        if (end == std::string_view::npos || !std::ranges::all_of(text.substr(0, end), is_text))
            break;
        std::string_view line = text.substr(2, end - 2);
        if (line.ends_with('\r')) line.remove_suffix(1);
        const std::size_t space = std::min(line.find(' '), line.size());
        lines.values.emplace_back(line.substr(0, space),
                                  line.substr(std::min(space + 1, line.size())));
        lines.bytes += end + 1;
        text.remove_prefix(end + 1);
        if (line == "end") break;
    }
    return lines;
}

bool is_percent_line_so_far(std::string_view line) {
    constexpr std::string_view kBegin = "% ";
    const char c = line.back();
    if (line.size() > kLongestLine) return false;
    return line.size() <= kBegin.size() ? kBegin.starts_with(line) : is_text(c) || c == '\n';
}

bool is_last_percent_line(std::string_view line) {
    return line == "% end\n" || line == "% end\r\n";
}

std::optional<EvtHeader> find_evt_header(std::span<const std::byte> first_bytes) {
    const PercentLines lines = read_percent_lines(first_bytes);
    const std::string_view name = format_name(lines);
    if (name.empty()) return {};
    EvtHeader header;
    header.stream.format = name;
    header.stream.data_offset = lines.bytes;
    header.stream.serial = lines.value("serial_number");
    header.stream.sensor_name = sensor_name(lines);
    header.stream.source_text = lines.value("plugin_name");
    find_size(lines, header.stream);
    header.halves_swapped = name == "evt21" && are_halves_swapped(lines);
    // Nearer to the ends of time than this, sums could overflow.
    const auto base = number_in<std::int64_t>(lines.value("time_base_us")).value_or(0);
    if (base > -(std::int64_t(1) << 61) && base < (std::int64_t(1) << 61))
        header.time_base_us = base;
    return header;
}

std::string evt_format_said(std::span<const std::byte> first_bytes) {
    constexpr std::size_t kLongestName = 40;
    const PercentLines lines = read_percent_lines(first_bytes);
    const std::string_view format = lines.value("format");
    const std::string_view name =
        format.empty() ? lines.value("evt") : format.substr(0, format.find(';'));
    return std::string(name.substr(0, kLongestName));
}

bool is_of_other_format(std::span<const std::byte> header, std::string_view format) {
    if (const auto found = find_evt_header(header)) return found->stream.format != format;
    const bool is_dat = !read_percent_lines(header).value("Data").empty();  // "% Data file ..."
    return is_dat || !evt_format_said(header).empty();
}

EvtHeader stated_evt_header(std::span<const std::byte> first_bytes, std::string_view format) {
    EvtHeader header;
    header.stream.format = format;
    header.stream.data_offset = read_percent_lines(first_bytes).bytes;
    return header;
}

EvtHeader read_evt_header(std::span<const std::byte> first_bytes) {
    if (const auto header = find_evt_header(first_bytes)) return *header;
    const std::string said = evt_format_said(first_bytes);
    throw Error(ErrorKind::input,
                "RAW header: expected a line \"% format EVT2|EVT21|EVT3\" or \"% evt "
                "2.0|2.1|3.0\", found " +
                    (said.empty() ? "none" : said) +
                    "; without one, --input-format and --input-size state both");
}

}  // namespace eventide
