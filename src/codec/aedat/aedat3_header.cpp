// The lines of text before the packets of AEDAT 3.
#include "src/codec/aedat/aedat3.h"
#include "src/codec/aedat/aedat_header.h"
#include "src/core/error.h"
#include "src/core/list_text.h"
#include "src/core/number_text.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace eventide {

namespace {

struct NamedSize {
    std::string_view name;  ///< how the source's name begins, in upper case
    int width, height;
};
constexpr std::array kSizes{
    NamedSize{"DVS128", 128, 128},    NamedSize{"DAVIS240", 240, 180},
    NamedSize{"DAVIS346", 346, 260},  NamedSize{"DAVIS208", 208, 192},
    NamedSize{"DAVIS128", 128, 128},  NamedSize{"DAVIS640", 640, 480},
    NamedSize{"DVXPLORER", 640, 480},
};

void set_size_by_name(StreamHeader& header) {
    std::string upper;
    for (const char c : header.sensor_name)
        upper += char(std::toupper(static_cast<unsigned char>(c)));
    for (const NamedSize& size : kSizes)
        if (upper.starts_with(size.name)) {
            header.width = size.width;
            header.height = size.height;
            return;
        }
}

/// "640x480"
void set_size(StreamHeader& header, std::string_view geometry) {
    const auto [width, height] = size_in(geometry).value_or(std::pair{0, 0});
    if (width < 1 || height < 1 || width > 32768 || height > 32768) return;
    header.width = width;
    header.height = height;
}

/// "Source 1: DAVIS346", one a line.
std::vector<Aedat3Source> sources_in(const AedatHeaderLines& lines) {
    constexpr std::string_view kKey = "Source ";
    std::vector<Aedat3Source> sources;
    for (const std::string_view line : lines.lines) {
        const std::size_t key = line.find_first_not_of(" \t");
        if (key == line.npos || !line.substr(key).starts_with(kKey)) continue;
        std::string_view name = line.substr(key + kKey.size());
        const auto number = take_number<int>(name);
        if (!number) continue;
        name.remove_prefix(std::min(name.find_first_not_of(" \t:"), name.size()));
        sources.push_back(
            {*number, std::string(name.substr(0, name.find_last_not_of(" \t\r") + 1))});
    }
    return sources;
}

/// The one wanted, or the first; the others go into header.others.
void choose_source(Aedat3Header& header, const std::vector<Aedat3Source>& sources,
                   std::string_view wanted) {
    const auto is_wanted = [&](const Aedat3Source& source) {
        return wanted.empty() || std::to_string(source.number) == wanted;
    };
    const auto chosen = std::ranges::find_if(sources, is_wanted);
    if (chosen == sources.end() && !wanted.empty()) {
        const std::string found = list_of(sources, [](const Aedat3Source& source) {
            return std::to_string(source.number) + " (" + source.name + ")";
        });
        throw Error(ErrorKind::usage, "AEDAT 3: expected a source " + std::string(wanted) +
                                          ", found " + (found.empty() ? "none" : found));
    }
    if (chosen == sources.end()) return;
    header.source = chosen->number;
    header.stream.sensor_name = chosen->name;
    for (const Aedat3Source& source : sources)
        if (source.number != chosen->number) header.others.push_back(source);
}

}  // namespace

Aedat3Header read_aedat3_header(std::span<const std::byte> first_bytes, std::string_view source) {
    const AedatHeaderLines lines = read_aedat_lines(first_bytes);
    if (lines.lines.empty() || !lines.lines[0].starts_with("!AER-DAT3."))
        throw Error(ErrorKind::input,
                    "AEDAT 3: expected a first line \"#!AER-DAT3.1\", found none");
    const std::string_view format = find_value(lines, "Format");
    if (!format.empty() && format != "RAW")
        throw Error(ErrorKind::input, "AEDAT 3: expected Format RAW, found \"" +
                                          std::string(format.substr(0, 40)) + "\"");
    Aedat3Header header;
    header.lower_left = lines.lines[0].starts_with("!AER-DAT3.0");
    header.stream.format = "aedat3";
    header.stream.data_offset = lines.end;
    header.stream.source_text = find_value(lines, "Start-Time");
    choose_source(header, sources_in(lines), source);
    set_size_by_name(header.stream);
    set_size(header.stream, find_value(lines, "Geometry"));
    return header;
}

}  // namespace eventide
