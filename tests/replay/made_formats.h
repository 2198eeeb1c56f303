// Events as files of every format, also of those the project does not write.
#pragma once

#include "tests/replay/recording_files.h"

#include <algorithm>
#include <string>
#include <vector>

namespace eventide {

inline std::string little_endian(std::uint64_t value, int bytes) {
    std::string out;
    for (int i = 0; i < bytes; ++i) out += char(value >> (8 * i) & 0xFF);
    return out;
}

inline std::string big_endian(std::uint32_t value, int bytes) {
    std::string out = little_endian(value, bytes);
    std::reverse(out.begin(), out.end());
    return out;
}

/// DVS128 words, in AEDAT 1.0 (16-bit addresses) or 2.0.
inline std::string dvs128(const std::vector<Event>& events, int version) {
    std::string content = "#!AER-DAT" + std::to_string(version) + ".0\r\n";
    if (version == 2) content += "# AEChip: DVS128\r\n#End Of ASCII Header\r\n";
    for (const Event& e : events)
        content += big_endian(std::uint32_t(127 - e.y) << 8 | std::uint32_t(127 - e.x) << 1 |
                                  std::uint32_t(e.polarity == Polarity::off),
                              2 * version) +
                   big_endian(std::uint32_t(to_us(e.t)) & 0x7FFFFFFF, 4);
    return content;
}

inline std::string dat(const std::vector<Event>& events) {
    std::string content("% Version 2\n% Width 128\n% Height 128\n\x0C\x08");
    for (const Event& e : events)
        content +=
            little_endian(std::uint64_t(to_us(e.t)), 4) +
            little_endian(
                std::uint64_t(e.x) | std::uint64_t(e.y) << 14 | std::uint64_t(e.polarity) << 28, 4);
    return content;
}

/// Each event with the high time before it; in EVT2.1 one bit of the mask.
inline std::string evt2(const std::vector<Event>& events, bool vectors) {
    std::string content = vectors ? "% evt 2.1\n" : "% evt 2.0\n";
    content += "% geometry 128x128\n% end\n";
    for (const Event& e : events) {
        const auto t = std::uint64_t(to_us(e.t));
        const std::uint64_t high = 0x80000000U | (t >> 6 & 0x0FFFFFFF);
        const std::uint64_t word =
            std::uint64_t(e.polarity) << 28 | (t & 0x3F) << 22 | std::uint64_t(e.x) << 11 | e.y;
        content += vectors ? little_endian(high << 32, 8) + little_endian(word << 32 | 1, 8)
                           : little_endian(high, 4) + little_endian(word, 4);
    }
    return content;
}

/// Five bytes each, after as many as it takes to let the time pass.
inline std::string event_stream(const std::vector<Event>& events) {
    std::string content("Event Stream\x02\0\0\x01", 16);
    content += little_endian(128, 2) + little_endian(128, 2);
    std::int64_t now = 0;
    for (const Event& e : events) {
        std::int64_t step = to_us(e.t) - now;
        now = to_us(e.t);
        for (; step >= 0x7F; step -= 0x7F) content += '\xFF';
        content += char(step << 1 | std::int64_t(e.polarity));
        content += little_endian(e.x, 2) + little_endian(std::uint64_t(127 - e.y), 2);
    }
    return content;
}

inline std::string write_as(const TestFolder& folder, const std::string& format,
                            const std::vector<Event>& events) {
    const std::string name = "a." + format;
    if (format == "aedat1") return folder.write(name, dvs128(events, 1));
    if (format == "aedat2") return folder.write(name, dvs128(events, 2));
    if (format == "es") return folder.write(name, event_stream(events));
    if (format == "dat") return folder.write(name, dat(events));
    if (format == "evt2") return folder.write(name, evt2(events, false));
    if (format == "evt21") return folder.write(name, evt2(events, true));
    return write_recording(folder.path(name), format, events);
}

}  // namespace eventide
