// What an AEDAT4 file says first: compression, where its table lies, and its streams.
#pragma once

#include "src/codec/aedat4/aedat4_compression.h"
#include "src/codec/stream.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace eventide {

constexpr std::string_view kAedat4Magic = "#!AER-DAT4.0\r\n";

/// The kinds of packets read.
enum class Aedat4Kind : std::uint8_t { events, image, imu, triggers };

/// The flatbuffer identifier of their packets.
constexpr std::string_view identifier_of(Aedat4Kind kind) {
    switch (kind) {
        case Aedat4Kind::image:
            return "FRME";
        case Aedat4Kind::imu:
            return "IMUS";
        case Aedat4Kind::triggers:
            return "TRIG";
        case Aedat4Kind::events:
            break;
    }
    return "EVTS";
}

/// Empty for packets that are not read.
constexpr std::optional<Aedat4Kind> kind_of(std::string_view identifier) {
    for (const Aedat4Kind kind :
         {Aedat4Kind::events, Aedat4Kind::image, Aedat4Kind::imu, Aedat4Kind::triggers})
        if (identifier == identifier_of(kind)) return kind;
    return std::nullopt;
}

struct Aedat4Stream {
    std::int32_t id = 0;
    std::string identifier;     ///< of its packets: "EVTS", ...
    int width = 0, height = 0;  ///< px; 0 where it does not say
    std::string source;         ///< "DAVIS346_00000104"
    int colour_filter = 0;      ///< libcaer's number; 0 none
};

struct Aedat4Header {
    StreamHeader stream;
    Aedat4Compression compression = Aedat4Compression::none;
    std::int64_t table_position = -1;  ///< -1: never written
    std::vector<Aedat4Stream> streams;
    /// Per kind the stream that is read: the first of the camera of the event stream that is, for a
    /// file may hold several cameras, or the same camera's data before and after a filter.
    std::array<std::optional<std::int32_t>, 4> chosen;
};

/// `first_bytes` hold the whole header. `events`: the number of the event stream to be read; empty:
/// the first. Throws Error: input when it is none, usage where it names no such event stream.
Aedat4Header read_aedat4_header(std::span<const std::byte> first_bytes,
                                std::string_view events = {});

/// The streams that the XML of an info node describes; what cannot be read is left out.
std::vector<Aedat4Stream> read_aedat4_streams(std::string_view xml);

}  // namespace eventide
